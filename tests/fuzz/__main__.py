"""The long run: mutants of all kinds in processes that are watched, then attacks on whole commands.

    python -m tests.fuzz --count 10000 --minutes 60

A mutant that takes more than 20 s, more than 1 GB, or ends with a traceback is a failure; it is
printed with its kind and seed. The exit code is 1 where there is one.
"""

import argparse
import json
import os
import queue
import resource
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections import Counter
from pathlib import Path

from tests.fuzz import attacks, cases
from tipoff import scenes

SECONDS, BYTES = 20.0, 2**30
_START = 300.0  # s for a process to load its libraries and compile its kernels
_SHOWN = 1500  # characters of a traceback
_SOLIDS = 100  # mutants of other kinds per mutant of a solid, which takes seconds


def worker() -> None:
    """Run the mutants that standard input names, a line each, and answer with a line of JSON."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what libraries print
    cases.take_steps(scenes.load("tiny").condition("phi15"))
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    print(json.dumps({"ready": True}), file=answers, flush=True)
    for line in sys.stdin:
        kind, seed = line.rsplit(maxsplit=1)
        resource.setrlimit(resource.RLIMIT_DATA, (used + 2 * BYTES, hard))
        before, why = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, ""
        with tempfile.TemporaryDirectory() as folder:
            try:
                code = cases.outcome(kind, int(seed), Path(folder))
            except BaseException:
                code, why = -1, traceback.format_exc()[-_SHOWN:]
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
        if grown > BYTES:
            code, why = -2, f"{grown / 1e9:.2g} GB"
        print(json.dumps({"code": code, "why": why}), file=answers, flush=True)


class Watched:
    """A worker whose answers are awaited for a limited time."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.fuzz", "--worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._answers: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self._answer(_START)

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._answers.put(line)
        self._answers.put("")  # the process has ended

    def _answer(self, seconds: float) -> dict:
        try:
            line = self._answers.get(timeout=seconds)
        except queue.Empty:
            return {"code": -3, "why": f"more than {seconds:g} s"}
        return (
            json.loads(line) if line else {"code": -4, "why": f"ended with {self.process.wait()}"}
        )

    def run(self, kind: str, seed: int) -> dict:
        """Exit code of a mutant, and why it failed where the code is negative."""
        assert self.process.stdin is not None
        print(kind, seed, file=self.process.stdin, flush=True)
        return self._answer(SECONDS)

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.wait()


def mutants(count: int, first: int, until: float) -> int:
    """Run ``count`` mutants from seed ``first`` on, kind after kind; returns the number of failures."""
    kinds, found, failures = list(cases.KINDS), Counter(), 0
    watched = Watched()
    for number in range(count):
        if time.monotonic() > until:
            print(f"out of time after {number:,} mutants")
            break
        quick = [kind for kind in kinds if kind != "solid"]
        kind = "solid" if number % _SOLIDS == 0 else quick[number % len(quick)]
        answer = watched.run(kind, first + number)
        found[kind, answer["code"]] += 1
        if answer["code"] < 0:
            failures += 1
            print(f"{kind} {first + number}: {answer['why']}", flush=True)
        if answer["code"] < -1:  # a process that took too much is not used again
            watched.end()
            watched = Watched()
    watched.end()
    for kind in kinds:
        codes = {code: times for (name, code), times in sorted(found.items()) if name == kind}
        print(f"{kind:14}", ", ".join(f"exit {code}: {times:,}" for code, times in codes.items()))
    print(f"{sum(found.values()):,} mutants, {failures} failures", flush=True)
    return failures


def main() -> int:
    """Exit code of the long run."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--count", type=int, default=10_000, help="mutants")
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    parser.add_argument("--minutes", type=float, default=120.0, help="for all mutants")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.worker:
        worker()
        return 0
    failures = mutants(asked.count, asked.first, time.monotonic() + 60.0 * asked.minutes)
    for name, attack in attacks.ATTACKS.items():
        with tempfile.TemporaryDirectory() as folder:
            said = attack(Path(folder))
        print(f"{name}: {said or 'held'}", flush=True)
        failures += bool(said)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
