"""Kernels that several runs need are compiled side by side, each once."""

import gc
import sys
from dataclasses import replace
from types import ModuleType

import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import lowfi, scenes
from tipoff.workspace import compiling, kernel_marks
from tipoff.workspace.run import Run
from tipoff.workspace.store import Store

FALLING = scenes.load("tiny").replace({"contact": None, "friction": None})
FLYING = FALLING.replace({"platform": None, "gravity.x": "1 m/s**2"})


@pytest.fixture
def runs(monkeypatch, tmp_path):
    """A free flight, a run on compliant contact, and one that needs the kernel of the first."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    lighter = FALLING.replace({"payload.mass": "3 kg", "thrust_offset": None})
    first, last = (
        Run("lowfi", name, scene, lowfi.Numerics())
        for name, scene in (("first", FALLING), ("last", lighter))
    )
    return [first, pressed(0), last]


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


def refuse(run):
    raise ValueError(f"{run.label} cannot begin")


def test_a_warm_up_that_fails_ends_nothing(runs, tmp_path, capfd, monkeypatch):
    """The run compiles its own, and reports its own fault."""
    monkeypatch.setattr(compiling, "warm_up", refuse)
    compiling.compile_ahead("kernels", runs, workers=2)
    said = capfd.readouterr().err
    assert "kernels 2/2" in said and said.count("not compiled ahead (") == 2
    assert machine_codes(tmp_path) == 0


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
    kernel_marks.announce(same)  # with other effects
    assert capfd.readouterr().err == ""
    kernel_marks.announce(other)
    assert "once" in capfd.readouterr().err


def mark(scene, fidelity="lowfi"):
    return kernel_marks.mark(Run(fidelity, "a", scene, lowfi.Numerics()))


@pytest.mark.parametrize("fidelity", ["highfi", "lowfi"])
def test_an_effect_needs_no_kernel_of_its_own(fidelity):
    """Nor does a fixed platform, or another section. Control: other elements and another kind of contact
    do."""
    same = (FALLING, FLYING, scenes.load("rocket_rail"))
    other = {
        "highfi": mark(scenes.load("channel"), "highfi"),
        "lowfi": kernel_marks.mark(pressed(0)),
    }
    (found,) = {mark(scene, fidelity) for scene in same}
    assert found != other[fidelity]


def pressed(modes) -> Run:
    """A run whose rails have ``modes``."""
    numerics = lowfi.Numerics(modes=modes)
    return Run("lowfi", "a", REFERENCE, numerics, compliance=reference_compliance())


def test_any_number_of_modes_has_the_same_kernels(monkeypatch, tmp_path, capfd):
    """Control: another degree of the patterns has others."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))

    def announced(**numerics) -> str:
        run = pressed("auto")
        run = replace(run, numerics=replace(run.numerics, **numerics))
        kernel_marks.announce(run)
        kernel_marks.remember(run)
        return capfd.readouterr().err

    assert "compiling the kernels of model compliant" in announced()
    assert [announced(modes=modes) for modes in (0, 4, 20)] == [""] * 3
    assert "once" in announced(degree=2)


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
        lambda run: (marked.append(run), remember(run)),
    )
    for folder, count in (("two", 1), ("two", 1), ("three", 2)):
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / folder))
        with kernel_marks.first_use(pressed(0)):
            pass
        assert len(marked) == count and kernel_marks.are_there(pressed(0))


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
