"""Runs the missing chunks of an ensemble into its store, in threads of this machine or on a
cluster."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from tipoff.lowfi.ensemble import cluster, columns
from tipoff.lowfi.ensemble.batch import Case
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.store import Chunk, Store
from tipoff.lowfi.ensemble.threads import PIECE, completed

_Rows = Sequence[Mapping[str, Any]]


def fill(
    ensemble: Ensemble,
    store: Store,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int], None] | None = None,
) -> int:
    """Run the cases missing in ``store`` and return their number, in ``workers`` threads or on the
    Dask cluster at ``scheduler``.

    ``progress`` is called with the number of cases done. Raises StoreError when it cannot go on;
    stored cases stay, and the next call runs the rest.
    """
    pending = store.pending()
    missing = sum(end - begin for begin, end in map(store.bounds, pending))
    if not pending:
        return 0
    requested = ((number, ensemble.source.rows(*store.bounds(number))) for number in pending)
    stored = store.asked - missing

    def tell(more: int = 0) -> None:
        if progress:
            progress(stored + more)

    for chunk in (
        cluster.made(ensemble, store, requested, scheduler)
        if scheduler is not None
        else _here(ensemble, requested, workers, tell)
    ):
        store.write(chunk)
        stored += len(chunk.rows)
        tell()
    return missing


def _here(
    ensemble: Ensemble,
    requested: Iterable[tuple[int, _Rows]],
    workers: int | None,
    tell: Callable[[int], None],
) -> Iterator[Chunk]:
    """Chunks made here; ``tell`` is called with the number of cases done of the next one."""
    begun: deque[tuple[int, _Rows]] = deque()

    def pieces() -> Iterator[_Rows]:
        for number, rows in requested:
            begun.append((number, rows))
            yield from (rows[begin : begin + PIECE] for begin in range(0, len(rows), PIECE))

    cases: list[Case] = []
    for found in completed(ensemble.family(), pieces(), workers):
        cases += found
        if len(cases) == len(begun[0][1]):
            number, rows = begun.popleft()
            yield Chunk(number, rows, columns.of_cases(cases), [case.message for case in cases])
            cases = []
        else:
            tell(len(cases))
