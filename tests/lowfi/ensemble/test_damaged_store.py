"""Damage to the store of an ensemble, in results, lists of failures or descriptions of arrays, is
reported and repaired to the same bits."""

import json
from pathlib import Path

import numpy as np
import pytest

from tipoff.files import with_digest
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble import store as stores
from tipoff.lowfi.ensemble.columns import Columns
from tipoff.lowfi.ensemble.store import Chunk, Store, StoreError

CASES, CHUNK, IDENTITY = 20, 8, {"scene": "a scene", "cases": {"seed": 1}}
KEYS = ["payload.mass", "thrust.peak"]


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    monkeypatch.setattr(stores, "CHUNK", CHUNK)


def opened(path, identity=IDENTITY, scene="words") -> Store:
    return Store(path, CASES, KEYS, identity, {"scene": {"description": scene}})


def chunk(store: Store, number: int) -> Chunk:
    """The results of a chunk, which depend on its number alone: every fifth case diverged, every
    seventh warns."""
    begin, end = store.bounds(number)
    random, count = np.random.default_rng(number), end - begin
    cases = np.arange(begin, end)
    status = np.where(cases % 5 == 0, columns.STATUSES.index("diverged"), 0).astype(np.int8)
    results = Columns(
        status=status,
        steps=cases.astype(np.int64),
        **{
            name: random.random((count, 3) if name in columns.VECTORS else count)
            for name in columns.UNITS
        },
    )
    messages = ["too deep" if case % 5 == 0 else "close" if case % 7 == 0 else "" for case in cases]
    return Chunk(
        number,
        [{"payload.mass": float(9 + case), "thrust.peak": 6e3} for case in cases],
        results,
        messages,
    )


def fill(store: Store) -> list[int]:
    """Run the missing chunks and return their numbers."""
    pending = store.pending()
    for number in pending:
        store.write(chunk(store, number))
    return pending


@pytest.fixture
def whole(tmp_path):
    """A full store, and its contents."""
    store = opened(tmp_path / "store")
    assert fill(store) == [0, 1, 2]
    return tmp_path / "store", state_of(store)


def state_of(store: Store):
    results, messages = store.results()
    return store.digest(), store.failures(), messages, [array.tobytes() for array in results]


def files_of(path, pieces: bool) -> list[Path]:
    """Files of a store. Without all ``pieces``, of each array one chunk, another one from array to
    array, and all other files."""
    files = sorted(item for item in path.rglob("*") if item.is_file())
    arrays = sorted({item.parent for item in path.rglob("c")})
    for number, array in enumerate(arrays):
        parts = [item for item in files if array / "c" in item.parents]
        assert len(parts) == 3
        files = [item for item in files if pieces or item not in parts or item == parts[number % 3]]
    return files


@pytest.mark.case("X25")
@pytest.mark.parametrize("pieces", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_any_bit_of_any_file_is_found_and_repaired(whole, tmp_path, capsys, pieces):
    """The damaged places differ from file to file; lists of failures are damaged more often."""
    path, expected = whole
    for number, file in enumerate(files_of(path, pieces)):
        content = file.read_bytes()
        for place in [
            (number * 7919 + k * 104729) % len(content)
            for k in range(3 if file.parent.name == "done" else 1)
        ]:
            damaged = bytearray(content)
            damaged[place] ^= 1 << place % 8
            file.write_bytes(damaged)
            capsys.readouterr()
            store = opened(path)
            again = fill(store)
            assert state_of(store) == expected, (file, place)
            line = capsys.readouterr().err
            assert again or "written again" in line or json.loads(damaged) == json.loads(content), (
                file,
                place,
            )
            assert not again or "are run again" in line
            file.write_bytes(content)


# of a list of failures, whose digest does not fit
EDITS = [
    lambda mark: mark["failures"].pop(),
    lambda mark: mark["failures"][0].update(reason="none"),
    lambda mark: mark.update(warnings={}),
    lambda mark: mark.update(failed=0),
    lambda mark: mark.update(digest="0" * 64),
]
# of its layout, with a digest that fits, as in a store of another version
LAYOUTS = [
    lambda mark: mark["failures"][0].pop("case"),
    lambda mark: mark["failures"][0].update(case=3),
    lambda mark: mark["failures"][0].update(case="ten"),
    lambda mark: mark["failures"][0].update(reason=None),
    lambda mark: mark.update(failures={"case": 10}),
    lambda mark: mark.update(failures=None),
    lambda mark: mark.pop("warnings"),
    lambda mark: mark.update(warnings=["close"]),
    lambda mark: mark.update(warnings={"ten": "close"}),
]


@pytest.mark.parametrize(
    ("change", "fits"), [(edit, False) for edit in EDITS] + [(layout, True) for layout in LAYOUTS]
)
def test_an_edited_list_of_failures_is_found(whole, capsys, change, fits):
    """Control: the same list unchanged, with its digest."""
    path, expected = whole
    file = path / "done" / "000001.json"
    mark = json.loads(file.read_text())
    file.write_text(json.dumps(with_digest(mark)))
    assert state_of(opened(path)) == expected  # Control
    change(mark)
    file.write_text(json.dumps(with_digest(mark) if fits else mark))
    store = opened(path)
    for ask in (store.failures, store.results, store.digest):
        with pytest.raises(
            StoreError,
            match="000001.json is damaged or was edited; the same command runs its cases again",
        ):
            ask()
    assert not store.holds(12) and store.holds(3)
    assert fill(store) == [1] and state_of(store) == expected
    line = f"{file} is damaged or was edited: the cases 8 to 15 are run again"
    assert line in capsys.readouterr().err


@pytest.mark.parametrize("number", [1, CASES // CHUNK])
@pytest.mark.parametrize(
    "harm",
    [
        lambda path: path.unlink(),
        lambda path: path.write_bytes(path.read_bytes()[:-40]),
        lambda path: path.write_bytes(b"\0" + path.read_bytes()[1:]),
    ],
    ids=["lost", "cut", "another header"],
)
def test_a_lost_or_cut_piece_of_an_array_is_run_again(whole, harm, number):
    """A whole one, and the last, which is short."""
    path, expected = whole
    (piece,) = (path / "cases.zarr" / "rate" / "c" / str(number)).glob("*")
    harm(piece)
    store = opened(path)
    assert fill(store) == [number] and state_of(store) == expected


def test_descriptions_are_written_again_only_for_whose_store_it_is(whole, capsys):
    path, expected = whole
    description = path / "cases.zarr" / "zarr.json"
    content = description.read_text()
    # words of the scene are no part of the identity
    assert state_of(opened(path, scene="other words")) == expected
    assert capsys.readouterr().err == "" and description.read_text() == content
    with pytest.raises(StoreError, match="holds another ensemble: cases differ"):
        opened(path, IDENTITY | {"cases": {"seed": 2}})
    # an edit cannot pass one ensemble for another
    description.write_text(content.replace('"seed": 1', '"seed": 2'))
    with pytest.raises(
        StoreError, match="no store of an ensemble, or its cases.zarr/zarr.json is damaged"
    ):
        opened(path, IDENTITY | {"cases": {"seed": 2}})
    assert state_of(opened(path)) == expected and json.loads(description.read_text()) == json.loads(
        content
    )
    for mark in (path / "done").iterdir():
        mark.unlink()
    description.write_text("{")
    with pytest.raises(StoreError, match="damaged"):
        opened(path)


def test_an_array_that_claims_another_length_is_described_again(whole, capsys):
    """Cases that were not requested would be among the results, as not run."""
    path, expected = whole
    file = path / "cases.zarr" / "status" / "zarr.json"
    file.write_text(file.read_text().replace(str(CASES), str(CASES + 1), 1))
    assert state_of(opened(path)) == expected
    assert f"{file} is damaged or was edited: it is written again" in capsys.readouterr().err
