"""Some hundred mutants of each kind, and controls: the fuzzer reaches what lies behind the first check,
and sees a traceback."""

import pytest

from tests.fuzz import cases

SHORT = {"curve": 40, "mesh": 40, "solid": 1}  # of the slower kinds
COUNT = 80
CODES = {0, 1, 2}


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=[pytest.mark.gmsh] if kind == "solid" else [])
        for kind in cases.KINDS
        if kind != "step"  # which needs compiled kernels
    ],
)
def test_mutants_end_with_an_exit_code(kind, tmp_path, capfd):
    found = []
    for seed in range(SHORT.get(kind, COUNT)):
        folder = tmp_path / str(seed)
        folder.mkdir()
        found.append(cases.outcome(kind, seed, folder))
    assert set(found) <= CODES
    # Control: some mutants pass all checks, and some are refused.
    assert kind == "solid" or {0, 2} <= set(found)
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
