"""Cases in threads. Kernels release the interpreter lock, and runs share no data, so the number of
threads changes no bit."""

import os
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.lowfi.ensemble.batch import Case, Family

# cases set up together: large against the cost of a call, small against memory
PIECE = 256


def completed(
    family: "Family", pieces: Iterable[Sequence[Mapping[str, Any]]], workers: int | None = None
) -> "Iterator[list[Case]]":
    """Cases of each of ``pieces`` of rows, in their order; free threads take the next piece."""
    count = workers or os.cpu_count() or 1
    waiting: deque[list[Future[list[tuple[int, Case]]]]] = deque()
    with ThreadPoolExecutor(count) as pool:
        for rows in pieces:
            # Setting up holds the interpreter lock, kernels do not: this thread sets up, the others
            # run.
            waiting.append([pool.submit(job) for job in family.jobs(rows)])
            while len(waiting) > count:
                yield in_order(future.result() for future in waiting.popleft())
        while waiting:
            yield in_order(future.result() for future in waiting.popleft())


def in_order(found: "Iterable[list[tuple[int, Case]]]") -> "list[Case]":
    """Cases of a piece, from pairs of a row's number and its case."""
    return [case for _, case in sorted(chain.from_iterable(found), key=lambda pair: pair[0])]
