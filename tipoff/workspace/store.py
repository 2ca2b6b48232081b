"""Stored results of runs: ``out/<scene>/<fidelity>/<label>-<key>.nc``.

    key = SHA-256(physical inputs of the scene, numerics, calibrated constants, rail compliance,
                  code and versions of libraries that the fidelity depends on)

A run is loaded if its file exists and matches its digest; otherwise it is made and written
atomically (``tipoff.cache``). So an interrupted study continues with the missing runs, and an old
result is never used after a change of inputs, code or libraries, or from a damaged file. A run of
the reference in progress has a checkpoint ``<label>-<key>.checkpoint``, which is removed after the
result is written.

Runs are parallel in threads: the kernels release the interpreter lock. The mesh generator needs the
main thread, so it is called first.
"""

import functools
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from pathlib import Path

from tipoff import cache
from tipoff.faults import InputError
from tipoff.files import discard
from tipoff.results.trajectory import Trajectory, content
from tipoff.workspace import kernel_marks
from tipoff.workspace.attempt import attempt
from tipoff.workspace.compiling import compile_ahead
from tipoff.workspace.errors import StudyError
from tipoff.workspace.progress import Board, Interrupted, say, team
from tipoff.workspace.run import Run, execute, prepare

# stop all runs: bad input, Ctrl-C, and refusals of this machine
_STOPPING = (InputError, StudyError, Interrupted, OSError, MemoryError)
RUNS: cache.Cache[Trajectory] = cache.binary(content, Trajectory.load)


class Store:
    """Trajectories below one folder."""

    def __init__(
        self, folder: Path, workers: int = 1, checkpoint_every: float = 60.0, resume: bool = True
    ):
        self.folder, self.workers = Path(folder), workers
        self.checkpoint_every, self.resume = checkpoint_every, resume
        self.made = 0  # runs

    def path(self, run: Run) -> Path:
        """File of the result of ``run``."""
        return cache.file(self.folder / run.fidelity, run.label, run.key, ".nc")

    def checkpoint(self, run: Run) -> Path:
        """File of the checkpoint of ``run``."""
        return self.path(run).with_suffix(".checkpoint")

    def load(self, run: Run) -> Trajectory | None:
        """The stored result, or None without a readable one. Names a damaged file on standard
        error."""
        return RUNS.get(self.path(run), run.key, f"{run.label} is run again")

    def get(self, run: Run) -> Trajectory:
        """The result of one run, from the store or made now."""
        return self.fill(run.fidelity, [run])[0]

    def fill(self, title: str, runs: Sequence[Run]) -> list[Trajectory]:
        """Results of ``runs`` in their order; missing ones are run, ``workers`` at a time, with
        progress on standard error.

        Ctrl-C stops the runs in progress and raises KeyboardInterrupt; finished results stay. After
        an error of the program in one run the others continue; then StudyError is raised.
        """
        found = {run.key: trajectory for run in runs if (trajectory := self.load(run)) is not None}
        missing = list({run.key: run for run in runs if run.key not in found}.values())
        if missing:
            found |= self._make(title, missing)
        return [found[run.key] for run in runs]

    def _make(self, title: str, runs: list[Run]) -> dict[str, Trajectory]:
        for run in runs:
            prepare(run)
        compile_ahead(f"{title}, kernels", runs, self.workers)
        made: dict[str, Trajectory] = {}
        # Parallel runs are fastest with one thread each: threads of one run would wait for each
        # other.
        threads = None if min(self.workers, len(runs)) == 1 else 1
        with Board(title, len(runs)) as board, team(board, self.workers) as pool:
            pending = {pool.submit(self._one, run, board, threads): run for run in runs}
            failed = []
            for future in as_completed(pending):
                run = pending[future]
                found, reason = attempt(run.label, future.result, _STOPPING)
                if found is None:
                    failed.append(f"{run.label}: {reason}")
                else:
                    made[run.key] = found
        if failed:
            raise StudyError("these runs failed:\n  " + "\n  ".join(failed))
        return made

    def _one(self, run: Run, board: Board, threads: int | None) -> Trajectory:
        progress = board.callback(run.label)
        progress(0.0)
        make = self._kept if run.fidelity == "highfi" else execute
        with kernel_marks.first_use(run):
            trajectory = make(run, progress, threads)
        RUNS.put(self.path(run), run.key, trajectory)
        self.made += 1
        discard(self.checkpoint(run))
        message = f" ({trajectory.message})" if trajectory.message else ""
        board.finished(
            run.label, f"{trajectory.status}{message} in {trajectory.cost['wall_s']:.3g} s"
        )
        return trajectory

    def _kept(self, run: Run, progress: Callable[[float], None], threads: int | None) -> Trajectory:
        """Run the reference from its checkpoint, or from the beginning without a usable one."""
        from tipoff import highfi

        path = self.checkpoint(run)
        if not self.resume:
            discard(path)
        make = functools.partial(
            execute,
            run,
            progress,
            threads,
            checkpoint=path,
            checkpoint_every=self.checkpoint_every,
            resume=True,
        )
        if path.is_file():
            say(f"  {run.label} continues from {path}")
        try:
            return make()
        except highfi.CheckpointError as fault:
            say(f"  {path} {fault.reason}, so {run.label} starts from the beginning")
        discard(path)
        return make()
