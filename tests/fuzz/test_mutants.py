"""Some tens of mutants of each kind, and controls: the fuzzer reaches what lies behind the first check,
and sees a traceback."""

import pytest

from tests.fuzz import cases

SHORT = {"solid": 1, "run": 20, "store": 10}
COUNT, ALL = 40, 80
CODES = {0, 1, 2}


def _mutants():
    """Each kind with a count, and a larger count for the slow tests."""
    for kind in cases.KINDS:
        if kind in ("step", "checkpoint"):  # which need compiled kernels
            continue
        marks = [pytest.mark.gmsh] if kind == "solid" else []
        yield pytest.param(kind, SHORT.get(kind, COUNT), marks=marks, id=kind)
        if kind not in (*SHORT, "curve", "mesh"):
            yield pytest.param(kind, ALL, marks=[*marks, pytest.mark.slow], id=f"more of {kind}")


@pytest.mark.parametrize("kind, count", list(_mutants()))
def test_mutants_end_with_an_exit_code(kind, count, tmp_path, capfd):
    found = []
    for seed in range(count):
        folder = tmp_path / str(seed)
        folder.mkdir()
        found.append(cases.outcome(kind, seed, folder))
    assert set(found) <= CODES
    # Control: some mutants pass all checks, and some are refused.
    # What is damaged in the store of an ensemble is made again.
    assert kind == "solid" or (kind == "store" and set(found) == {0}) or {0, 2} <= set(found)
    assert "Traceback" not in capfd.readouterr().err


def test_a_mutant_is_the_same_each_time(tmp_path):
    files = []
    for name in ("a", "b"):
        folder = tmp_path / name
        folder.mkdir()
        cases.outcome("scene", 7, folder)
        files.append((folder / "scene.toml").read_bytes())
    assert files[0] == files[1]


def test_a_traceback_is_seen(tmp_path, monkeypatch):
    """Control."""
    monkeypatch.setitem(cases.KINDS, "broken", lambda rng, folder: {}["missing"])
    with pytest.raises(KeyError):
        cases.outcome("broken", 0, tmp_path)
