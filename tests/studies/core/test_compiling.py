"""Kernels that several runs need are compiled side by side, each once."""

import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import lowfi, scenes
from tipoff.studies.core import compiling
from tipoff.studies.core.store import Run

FLYING = scenes.load("tiny").replace({"contact": None, "friction": None})


@pytest.fixture
def runs(monkeypatch, tmp_path):
    """A free flight with and without gravity, and one that needs the kernel of the first."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    changes = ({}, {"gravity.x": "1 m/s**2"}, {"payload.mass": "3 kg"})
    return [
        Run("lowfi", f"{number}", FLYING.replace(change), lowfi.Numerics())
        for number, change in enumerate(changes)
    ]


def compiled(folder):
    """Number of machine codes of the time loop below ``folder``."""
    return len(list(folder.glob("kernels/*integrate*/**/integrate.integrate-*.nbc")))


@pytest.mark.slow
def test_each_kernel_is_compiled_once(runs, tmp_path, capfd):
    compiling.compile_ahead("kernels", runs, workers=2)
    assert compiled(tmp_path) == 2
    assert "kernels 2/2" in capfd.readouterr().err
    compiling.compile_ahead("kernels", runs, workers=2)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("count, workers", [(3, 1), (1, 2)])
def test_a_run_alone_compiles_its_own(runs, tmp_path, count, workers):
    compiling.compile_ahead("kernels", runs[:count], workers)
    assert compiled(tmp_path) == 0


def test_the_first_compilation_is_announced_once(runs, capfd):
    first, other, same = runs
    compiling.announce(first)
    assert "compiling the kernels of model compliant" in capfd.readouterr().err
    compiling.remember(first)
    compiling.announce(same)  # the same effects
    assert capfd.readouterr().err == ""
    compiling.announce(other)
    said = capfd.readouterr().err
    assert "once" in said and "modes" not in said  # nothing presses a rail


def test_kernels_with_modes_of_the_rails_are_others(monkeypatch, tmp_path, capfd):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))

    def announced(modes) -> str:
        numerics = lowfi.Numerics(modes=modes)
        run = Run("lowfi", "", REFERENCE, numerics, compliance=reference_compliance())
        compiling.announce(run)
        compiling.remember(run)
        return capfd.readouterr().err

    assert "once, and a minute more if modes" in announced("auto")
    assert "once\n" in announced(0) and "once\n" in announced(4)
    assert [announced(modes) for modes in ("auto", 0, 20)] == ["", "", ""]
