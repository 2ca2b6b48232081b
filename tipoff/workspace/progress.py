"""Progress of several runs: bars with the remaining time on a terminal, else one line for each
finished run, and in long work a line now and then."""

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from tipoff.remaining import Remaining, duration

console = Console(stderr=True, highlight=False)
_SHOWN_AFTER = 2.0  # s; shorter work gets no bar
# s without a line off a terminal, at first and at most; it doubles with each line
_NOTED_AFTER, _NOTED_EVERY = 10.0, 60.0
_LOOKED_EVERY = 1.0  # s, whether a line is due, since a run that compiles reports nothing
_NAMED = 3  # runs in such a line


class Interrupted(Exception):
    """Raised inside a run by its progress callback after Ctrl-C."""


class Board:
    """Context manager that shows ``total`` runs; ``report`` and ``finished`` may be called from any
    thread."""

    def __init__(self, title: str, total: int):
        self._title, self._total, self._done = title, total, 0
        self._stop, self._lock = threading.Event(), threading.Lock()
        self._fractions: dict[str, float] = {}
        self._parts: dict[str, int] = {}  # of runs that began another part: its number
        self._bars: Progress | None = None
        self._tasks: dict[str, TaskID] = {}
        self._started = self._said = time.monotonic()
        self._remaining = Remaining(self._started)
        self._silence = _NOTED_AFTER  # s, until the next line without a bar
        self._over = threading.Event()

    def __enter__(self) -> "Board":
        if console.is_terminal:
            self._bars = Progress(
                TextColumn("{task.description}", justify="left"),
                BarColumn(),
                TextColumn("{task.percentage:3.0f} %"),
                TimeElapsedColumn(),
                TextColumn("left"),
                TimeRemainingColumn(),
                console=console,
                transient=True,
            )
        else:
            threading.Thread(target=self._look, daemon=True).start()
        return self

    def __exit__(self, *_) -> None:
        self._over.set()
        if self._bars is not None:
            self._bars.stop()

    def stop(self) -> None:
        """Make every running callback raise Interrupted."""
        self._stop.set()

    def callback(self, label: str) -> Callable[[float], None]:
        """Progress callback of one run; its argument is the completed fraction, 0 to 1. A smaller one
        than before begins another part of the run, which has no known share of it."""

        def report(fraction: float) -> None:
            if self._stop.is_set():
                raise Interrupted(label)
            with self._lock:
                share = min(max(float(fraction), 0.0), 1.0)
                if share < self._fractions.get(label, 0.0):
                    self._parts[label] = self._parts.get(label, 1) + 1
                self._fractions[label] = share
                self._count()
                self._draw()

        return report

    def finished(self, label: str, note: str) -> None:
        """Count a run as finished and print its line."""
        with self._lock:
            self._done += 1
            self._fractions.pop(label, None)
            self._parts.pop(label, None)
            self._count()
            if self._bars is not None and label in self._tasks:
                self._bars.remove_task(self._tasks.pop(label))
            self._said = time.monotonic()
            say(f"  {self._title} {self._done}/{self._total}  {label}: {note}")
            self._draw()

    def _count(self) -> None:
        """Note how much of all runs is done. A run in a further part counts as not begun."""
        known = (share for label, share in self._fractions.items() if label not in self._parts)
        self._remaining.note(time.monotonic(), (self._done + sum(known)) / self._total)

    def _look(self) -> None:
        while not self._over.wait(_LOOKED_EVERY):
            with self._lock:
                self._draw()

    def _draw(self) -> None:
        now = time.monotonic()
        if self._bars is None:
            if now - self._said >= self._silence:
                self._note(now)
            return
        if now - self._started < _SHOWN_AFTER:
            return
        self._bars.start()
        if "" not in self._tasks and self._total > 1:
            self._tasks[""] = self._bars.add_task(self._title, total=self._total)
        if self._total > 1:
            self._bars.update(self._tasks[""], completed=self._done + sum(self._fractions.values()))
        for label, fraction in self._fractions.items():
            if label not in self._tasks:
                self._tasks[label] = self._bars.add_task(f"  {label}", total=1.0)
            named = f"  {self._named(label)}"
            self._bars.update(self._tasks[label], completed=fraction, description=named)

    def _named(self, label: str) -> str:
        return f"{label}, part {self._parts[label]}" if label in self._parts else label

    def _note(self, now: float) -> None:
        """A line about the runs in progress."""
        self._said, self._silence = now, min(2.0 * self._silence, _NOTED_EVERY)
        taken = now - self._started
        words = "" if self._parts else self._remaining.words(now)
        left = words and f", {words}"
        shares = [
            f"{self._named(label)} {share:.0%}"
            for label, share in self._fractions.items()
            if share > 0.0
        ]
        more = f" and {len(shares) - _NAMED} more" if len(shares) > _NAMED else ""
        under_way = f"  {', '.join(shares[:_NAMED])}{more}" if shares else ""
        say(f"  {self._title} {self._done}/{self._total}{under_way} after {duration(taken)}{left}")


@contextmanager
def team(board: Board, workers: int) -> Iterator[ThreadPoolExecutor]:
    """Threads for the runs of ``board``.

    An exception in the block, such as Ctrl-C, cancels the runs that have not begun and stops the
    others at their next progress report. It does not wait for the threads, because one may be
    compiling a kernel.
    """
    pool = ThreadPoolExecutor(workers)
    try:
        yield pool
    except BaseException:
        try:  # in this order: the thread of a stopped run would begin the next one
            pool.shutdown(wait=False, cancel_futures=True)
        finally:
            board.stop()
        raise
    pool.shutdown()


def say(text: str) -> None:
    """Print one line for the user on standard error."""
    # Markup off: a condition may be called [x]. Soft wrap: a log file has no width.
    console.print(text, markup=False, soft_wrap=True)
