"""Cases in threads: kernels release the interpreter lock, and runs share nothing, so the worker count
changes no bit."""

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from typing import Any

from tipoff.lowfi.ensemble.batch import Case, Family

# cases set up together: enough for the calls to cost nothing, few enough for memory to stay flat
PIECE = 256


def completed(
    family: Family, pieces: Iterable[Sequence[Mapping[str, Any]]], workers: int | None = None
) -> Iterator[list[Case]]:
    """Cases of each of ``pieces`` of rows, in their order; a piece is taken when a thread is free
    for it soon."""
    count = _workers(workers)
    waiting: deque[list[Future[list[tuple[int, Case]]]]] = deque()
    with ThreadPoolExecutor(count) as pool:
        for rows in pieces:
            # Setting up holds the interpreter lock, stepping does not: one thread prepares what the
            # others run.
            waiting.append([pool.submit(job) for job in family.jobs(rows)])
            while len(waiting) > count:
                yield in_order(future.result() for future in waiting.popleft())
        while waiting:
            yield in_order(future.result() for future in waiting.popleft())


def in_order(found: Iterable[list[tuple[int, Case]]]) -> list[Case]:
    """Cases of a piece from what its jobs found, pairs of a row's number and its case."""
    return [case for _, case in sorted(chain.from_iterable(found), key=lambda pair: pair[0])]


def _workers(workers: int | None) -> int:
    return workers or os.cpu_count() or 1
