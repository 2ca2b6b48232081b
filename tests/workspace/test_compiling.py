"""Kernels that several runs need are compiled side by side, each once."""

import gc
import sys
from types import ModuleType

import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.studies.synthetic import flight
from tipoff import lowfi, scenes
from tipoff.workspace import compiling, kernel_marks
from tipoff.workspace.run import Run
from tipoff.workspace.store import Store

FALLING = scenes.load("tiny").replace({"contact": None, "friction": None})
FLYING = FALLING.replace({"platform": None})


@pytest.fixture
def runs(monkeypatch, tmp_path):
    """A free flight with and without gravity, and one that needs the kernel of the first."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    changes = ({}, {"gravity.x": "1 m/s**2"}, {"payload.mass": "3 kg"})
    return [
        Run("lowfi", f"{number}", FLYING.replace(change), lowfi.Numerics())
        for number, change in enumerate(changes)
    ]


def machine_codes(folder):
    """Number of machine codes of the time loop below ``folder``."""
    return len(list(folder.glob("kernels/*integrate*/**/integrate.integrate-*.nbc")))


@pytest.mark.slow
def test_each_kernel_is_compiled_once(runs, tmp_path, capfd):
    Store(tmp_path / "out", workers=2).fill("lowfi", runs)
    assert machine_codes(tmp_path) == 2
    assert "lowfi, kernels 2/2" in capfd.readouterr().err
    compiling.compile_ahead("kernels", runs, workers=2)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("count, workers", [(3, 1), (1, 2)])
def test_a_run_alone_compiles_its_own(runs, tmp_path, count, workers):
    compiling.compile_ahead("kernels", runs[:count], workers)
    assert machine_codes(tmp_path) == 0


def test_a_script_compiles_its_own(runs, tmp_path, monkeypatch):
    """Each further process would run the script once more. Control: above, as a module."""
    script = ModuleType("__main__")
    script.__file__ = str(tmp_path / "launches.py")
    monkeypatch.setitem(sys.modules, "__main__", script)
    compiling.compile_ahead("kernels", runs, workers=2)
    assert machine_codes(tmp_path) == 0


def test_the_first_compilation_is_announced_once(runs, capfd):
    first, other, same = runs
    kernel_marks.announce(first)
    assert "compiling the kernels of model compliant" in capfd.readouterr().err
    kernel_marks.remember(first)
    kernel_marks.announce(same)  # the same effects
    assert capfd.readouterr().err == ""
    kernel_marks.announce(other)
    said = capfd.readouterr().err
    assert "once" in said and "modes" not in said  # nothing presses a rail


def test_gravity_that_all_bodies_share_needs_no_kernel_of_its_own():
    """It is in no kernel where a free platform falls with the payload (``tests/lowfi/test_compiled``)."""

    def mark(scene):
        return kernel_marks.mark(Run("lowfi", "a", scene, lowfi.Numerics()))

    gravity = {"gravity.x": "1 m/s**2"}
    assert mark(FALLING.replace(gravity)) == mark(FALLING)
    assert mark(FLYING.replace(gravity)) != mark(FLYING)


def pressed(modes) -> Run:
    """A run whose rails have ``modes``."""
    numerics = lowfi.Numerics(modes=modes)
    return Run("lowfi", "a", REFERENCE, numerics, compliance=reference_compliance())


def test_kernels_with_modes_of_the_rails_are_others(monkeypatch, tmp_path, capfd):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))

    def announced(modes, chosen=False) -> str:
        kernel_marks.announce(pressed(modes), chosen)
        kernel_marks.remember(pressed(modes), chosen)
        return capfd.readouterr().err

    assert "again if modes" in announced("auto")
    # it began without modes, so the kernels with modes are not compiled
    assert "with modes of the rails" in announced("auto", chosen=True)
    assert [announced(modes) for modes in ("auto", 0, 4, 20)] == [""] * 4


def test_a_process_marks_the_kernels_that_it_uses_once(monkeypatch, tmp_path, capfd):
    """Control: a block that fails leaves no mark, and kernels in another folder are asked for."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "one"))
    with pytest.raises(ZeroDivisionError), kernel_marks.first_use(pressed(0)):
        raise ZeroDivisionError
    assert not kernel_marks.are_there(pressed(0)) and "once\n" in capfd.readouterr().err
    marked, remember = [], kernel_marks.remember
    monkeypatch.setattr(
        kernel_marks,
        "remember",
        lambda run, many: (marked.append(run), remember(run, many=many)),
    )
    for folder, count in (("two", 1), ("two", 1), ("three", 2)):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / folder))
        with kernel_marks.first_use(pressed(0)):
            pass
        assert len(marked) == count and kernel_marks.are_there(pressed(0))


def test_runs_of_given_modes_leave_kernels_for_those_that_choose(monkeypatch, tmp_path, capfd):
    """And so for many cases alone, which may need those with modes and those without."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    for modes, expected in ((4, "with modes"), (0, "once\n"), ("auto", "")):
        kernel_marks.announce(pressed(modes))
        said = capfd.readouterr().err
        assert expected in said and bool(expected) == bool(said)
        kernel_marks.remember(pressed(modes))
    kernel_marks.remember(pressed("auto"), many=True)
    kernel_marks.announce(pressed(0), many=True)
    assert "once\n" in capfd.readouterr().err


def test_modes_that_are_there_are_not_announced_as_missing(monkeypatch, tmp_path, capfd):
    """Control: above, where they are not there."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    kernel_marks.remember(pressed("auto"), chosen=True)
    kernel_marks.announce(pressed("auto"))
    assert "once\n" in capfd.readouterr().err


@pytest.mark.parametrize("chosen", [(), (2, 20)])
def test_a_run_that_chooses_modes_announces_their_kernels_before_it_goes_on(
    monkeypatch, tmp_path, capfd, chosen
):
    """And notes them only then. Control: a run that chooses none."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    said = []

    def run(scene, model, *, vibrates, **_):
        for modes in chosen:
            vibrates(modes)
            said.append(capfd.readouterr().err)
        return flight(model=model)

    monkeypatch.setattr(lowfi, "run", run)
    store = Store(tmp_path / "out")
    asked = pressed("auto")
    store.fill("lowfi", [asked])
    assert ["with modes of the rails" in text for text in said] == ([True, False] if chosen else [])
    assert kernel_marks.are_there(asked, chosen=True) == bool(chosen)
    assert kernel_marks.are_there(asked)


@pytest.mark.parametrize("before", [(700, 10, 10), (10**6, 99, 99)])
def test_python_collects_garbage_as_before_after_a_compilation(before):
    """After an error too. Inside it collects seldom, and never more often than before."""
    usual = gc.get_threshold()
    try:
        gc.set_threshold(*before)
        with pytest.raises(ZeroDivisionError), kernel_marks.rare_collections():
            assert gc.get_threshold() == tuple(map(max, before, (50_000, 50, 50)))
            raise ZeroDivisionError
        assert gc.get_threshold() == before
    finally:
        gc.set_threshold(*usual)
