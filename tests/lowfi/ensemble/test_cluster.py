"""The chunks of an ensemble on a real Dask cluster of processes: the bits of one process, also when
a worker is killed half-way."""

import os
import signal
import sys

import pytest

from tipoff import lowfi
from tipoff.lowfi.ensemble import cluster, twins
from tipoff.lowfi.ensemble import store as stores
from tipoff.lowfi.ensemble.fill import fill
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.store import StoreError
from tipoff.scenes import SceneError, load, uncertainty

distributed = pytest.importorskip("distributed")
CASES, CHUNK = 240, 20


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr(stores, "CHUNK", CHUNK)


def ensemble(cases: int = CASES) -> Ensemble:
    scene = load("clamped")
    return Ensemble(
        scene,
        Drawn(uncertainty.load("paper", scene, cases=cases)),
        None,
        lowfi.Numerics(relative_tolerance=1e-2),
    )


IN_THIS_PROCESS = pytest.mark.parametrize(
    "processes", [False, pytest.param(True, marks=pytest.mark.slow)]
)


def one_worker(processes: bool):
    """A cluster of one worker, which starts in no time in this process, and is lost like others."""
    return distributed.LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=processes,
        protocol="tcp://",
        dashboard_address=":0",
    )


@pytest.fixture(scope="module")
def two_workers():
    """A cluster whose workers come back when they die."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as workers:
        yield workers


def test_twins_have_the_bits_of_one_process(tmp_path, two_workers):
    """Each worker changes its Family."""
    asked = ensemble(cases=3 * CHUNK)
    for twin in (asked, *twins.of_ensemble(asked).values()):
        here, there = twin.store(tmp_path / twin.key), twin.store(tmp_path / f"{twin.key}-far")
        fill(twin, here)
        fill(twin, there, scheduler=two_workers.scheduler_address)
        assert there.pending() == [] and there.digest() == here.digest()


def test_a_worker_that_is_killed_changes_no_bit(tmp_path, two_workers):
    asked = ensemble()
    here = asked.store(tmp_path / "here")
    fill(asked, here)
    pids = [worker.pid for worker in two_workers.workers.values()]
    told, there = [], asked.store(tmp_path / "there")

    def kill_one(stored: int) -> None:
        told.append(stored)
        if len(told) == 3:
            os.kill(pids[0], signal.SIGKILL)

    address = two_workers.scheduler_address
    assert fill(asked, there, scheduler=address, progress=kill_one) == CASES
    assert len(told) == CASES // CHUNK and told[-1] == CASES
    assert pids[0] not in [worker.pid for worker in two_workers.workers.values()]
    assert there.pending() == [] and there.digest() == here.digest()


@IN_THIS_PROCESS
def test_a_lost_scheduler_ends_with_a_message_and_a_store_that_resumes(tmp_path, processes):
    asked = ensemble()
    store = asked.store(tmp_path / "store")
    workers = one_worker(processes)

    def lose(stored: int) -> None:
        if stored == 3 * CHUNK:
            workers.close()

    with pytest.raises(
        StoreError,
        match=r"lost the scheduler .*cases are stored, and the same command goes on from there",
    ):
        fill(asked, store, scheduler=workers.scheduler_address, progress=lose)
    kept = CASES - len(store.pending()) * CHUNK
    assert 3 * CHUNK <= kept < CASES
    assert fill(asked, store) == CASES - kept
    one = asked.store(tmp_path / "one")
    fill(asked, one)
    assert store.digest() == one.digest()


@IN_THIS_PROCESS
def test_a_last_worker_that_dies_ends_with_a_message(tmp_path, monkeypatch, processes):
    """Dask would wait for another one for ever."""
    asked = ensemble()
    store = asked.store(tmp_path / "store")
    with one_worker(processes) as workers:

        def dismiss(stored: int) -> None:
            if stored == 3 * CHUNK:
                monkeypatch.setattr(cluster, "PATIENCE", 0.5)  # it answered long ago
                for worker in list(workers.workers.values()):
                    workers.sync(worker.close)

        with pytest.raises(StoreError, match=r"no worker at .* for 0.5 s; .* are stored"):
            fill(asked, store, scheduler=workers.scheduler_address, progress=dismiss)
    assert 0 < len(store.pending()) <= CASES // CHUNK - 3


@pytest.mark.parametrize(
    "address", ["", "node1", "tcp://", "tcp://node1", "http://node1:80", "a:99999999", "a:0"]
)
def test_what_is_no_address_is_refused_at_once(tmp_path, monkeypatch, address):
    monkeypatch.setattr(distributed, "Client", lambda *_, **__: pytest.fail("a client was made"))
    asked = ensemble()
    with pytest.raises(SceneError, match="expected an address such as tcp://node1:8786"):
        fill(asked, asked.store(tmp_path / "store"), scheduler=address)


def test_tls_needs_certificates(tmp_path):
    asked = ensemble()
    with pytest.raises(SceneError, match=r"distributed\.comm\.tls"):
        fill(asked, asked.store(tmp_path / "store"), scheduler="tls://127.0.0.1:9")


def test_no_scheduler_and_no_dask_say_what_is_missing(tmp_path, monkeypatch):
    asked = ensemble()
    store = asked.store(tmp_path / "store")
    monkeypatch.setattr(cluster, "PATIENCE", 0.2)
    with pytest.raises(StoreError, match="no Dask scheduler answers at tcp://127.0.0.1:9"):
        fill(asked, store, scheduler="tcp://127.0.0.1:9")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(StoreError, match=r"tipoff\[cluster\]"):
        fill(asked, store, scheduler="tcp://127.0.0.1:9")


def test_a_worker_of_other_sources_is_refused():
    asked = ensemble()
    recipe = cluster.Recipe(
        asked.key, {"code": "other", "versions": {}}, asked.scene, None, asked.numerics
    )
    with pytest.raises(RuntimeError, match="other code and versions"):
        cluster.run_rows(recipe, asked.source.rows(0, 1))
