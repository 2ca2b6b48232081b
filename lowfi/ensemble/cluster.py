"""Chunks of an ensemble on a Dask cluster: workers run them; only this process draws the cases and
writes the store.

If a worker fails, its chunks go to others. If the scheduler or the last worker fails, the run ends
with a message, and the next run continues the store. Every worker must have the sources and library
versions of this process, so that the bits are the same.
"""

import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

from tipoff.faults import Fault, SceneError
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.request import Ensemble, code
from tipoff.lowfi.ensemble.store import Chunk, Store, StoreError
from tipoff.lowfi.ensemble.threads import PIECE, in_order
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene

PATIENCE = 30.0  # s without an answer of the scheduler, or without a worker
_LOOK, _FETCH = 0.1, 1.0  # s between checks of a chunk and its workers, and to fetch its result
_SCHEMES = ("tcp", "tls", "ucx", "ws", "wss")
_AHEAD = 2  # chunks sent per worker thread: one runs, the next waits
_RETRIES = 5  # of a chunk whose worker failed

_kept = threading.local()
_Rows = Sequence[Mapping[str, Any]]


class Recipe(NamedTuple):
    """Inputs of a worker for rows of an ensemble."""

    key: str  # under which the worker keeps the Family
    code: dict  # digest of sources, versions of libraries
    scene: Scene
    calibration: Calibration | None
    numerics: Numerics
    compliance: RailCompliance | None = None
    widening: float = 0.0  # m


def made(
    ensemble: Ensemble, store: Store, requested: Iterable[tuple[int, _Rows]], scheduler: str
) -> Iterator[Chunk]:
    """The ``requested`` chunks, given by number and rows, in the order of completion. Raises
    StoreError, and SceneError for an invalid address of the ``scheduler``."""
    distributed = _distributed()
    _require_address(scheduler)
    try:
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise StoreError(
            f"no Dask scheduler answers at {scheduler} ({error}); start one with: dask scheduler"
        ) from error
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
        yield from _made(
            client,
            Recipe(
                key=ensemble.key,
                code=code(),
                scene=ensemble.scene,
                calibration=ensemble.calibration,
                numerics=ensemble.numerics,
                compliance=ensemble.compliance,
                widening=ensemble.widening,
            ),
            iter(requested),
        )
    except TimeoutError as error:
        raise StoreError(
            f"no worker at {scheduler} for {PATIENCE:g} s; {store.progress()}; start one with: dask "
            f"worker {scheduler}"
        ) from error
    except (OSError, RuntimeError, distributed.CancelledError, distributed.KilledWorker) as error:
        what = "the cluster failed" if client.status == "running" else "lost the scheduler"
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise StoreError(f"{what} at {scheduler} ({reason}); {store.progress()}") from error
    finally:
        client.close(timeout=1.0)


def _made(client, recipe: Recipe, requested: Iterator[tuple[int, _Rows]]) -> Iterator[Chunk]:
    from distributed import as_completed

    sent: dict = {}
    ended = as_completed(loop=client.loop)

    def send() -> None:
        # checked each time: workers come and go
        wanted = _AHEAD * max(1, sum(client.nthreads().values()))
        for number, rows in islice(requested, max(0, wanted - len(sent))):
            future = client.submit(run_rows, recipe, rows, pure=False, retries=_RETRIES)
            sent[future] = number, rows
            ended.add(future)

    send()
    while sent:
        future, (results, messages) = _result(client, ended)
        number, rows = sent.pop(future)
        send()
        yield Chunk(number, rows, results, messages)


def _result(client, ended) -> tuple[Any, Any]:
    """Future and result of the next completed chunk. Raises TimeoutError after ``PATIENCE`` without
    a worker: Dask would wait forever for a chunk, or for a result that was lost with its worker."""
    future, served = None, time.monotonic()
    while True:
        if future is None and ended.has_ready():
            future = next(ended)
        try:
            if future is not None:
                return future, future.result(timeout=_FETCH)
        except TimeoutError:
            pass
        else:
            time.sleep(_LOOK)
        now = time.monotonic()
        if client.nthreads():
            served = now
        elif now - served > PATIENCE:
            raise TimeoutError


def _require_address(scheduler: str) -> None:
    """Raise SceneError unless this is the address of a scheduler. With a malformed address, the
    client would block the process at its end."""
    from distributed import Security
    from distributed.comm import addressing

    expected = "an address such as tcp://node1:8786"
    try:
        scheme, location = addressing.parse_address(scheduler)
        _, port = addressing.parse_host_port(location)
        wrong = scheme not in _SCHEMES or not 0 < port < 2**16
    except (ValueError, AssertionError):
        scheme, wrong = "", True
    if scheme == "tls" and not Security().get_connection_args("client").get("ssl_context"):
        wrong, expected = True, "certificates in Dask's settings distributed.comm.tls, or tcp://"
    if wrong:
        raise SceneError([Fault("scheduler", "address", repr(scheduler), expected)])


def run_rows(recipe: Recipe, rows: _Rows) -> tuple[Columns, list[str]]:
    """Results of ``rows`` and a message each; called in a worker. Raises RuntimeError if its
    sources or libraries differ."""
    if (here := code()) != recipe.code:
        other = [name for name, value in recipe.code.items() if here[name] != value]
        raise RuntimeError(
            f"this worker has other {' and '.join(other)} than the process that asks"
        )
    family = _family(recipe)
    pieces = (rows[begin : begin + PIECE] for begin in range(0, len(rows), PIECE))
    cases = [case for piece in pieces for case in in_order(job() for job in family.jobs(piece))]
    return columns.of_cases(cases), [case.message for case in cases]


def _family(recipe: Recipe) -> Family:
    """The Family of a recipe, kept from chunk to chunk; one per thread, because setting up a case
    changes it."""
    if getattr(_kept, "key", None) != recipe.key:
        _kept.key, _kept.family = recipe.key, Family(*recipe[2:])
    return _kept.family


def _distributed():
    try:
        import distributed
    except ImportError:
        raise StoreError("a cluster needs Dask: pip install 'tipoff[cluster]'") from None
    return distributed
