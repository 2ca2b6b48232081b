"""Quantities of the convergence study on stubbed runs: deflection, loads, stress."""

import math

import numpy as np
import pytest

from tests.studies.convergence import stub
from tipoff import scenes
from tipoff.studies.convergence import page, stresses
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.render import document
from tipoff.workspace import store as store_module
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study


def test_a_deflection_of_first_order_stands_beside_the_rates(finished):
    """As at the edge of a rigid mount: what is left is more than the last change."""
    found = stub.row(finished[1].result, "element size", "deflection under 100 N")
    assert found.values == pytest.approx([8.4, 9.2, 9.6]) and found.unit == "µm"
    assert found.order == pytest.approx(1.0) and found.method == "GCI"
    assert found.uncertainty == pytest.approx(1.25 * 0.4)
    assert found.nominal_uncertainty == pytest.approx(0.4 + 1.25 * 0.4)


def test_loads_of_the_one_pad_that_touches(finished):
    found = finished[1].result
    names = [item.quantity for item in found.quantities if item.parameter == "element size"]
    assert names == [
        "settled rate x",
        "settled rate y",
        "settled rate z",
        "settled axial velocity",
        "contact impulse, pad 2",
        "peak contact force below 1 kHz",
        "deflection under 100 N",
    ]
    assert stub.row(found, "element size", "contact impulse, pad 2").values == pytest.approx(
        [0.6] * 3
    )
    assert stub.row(found, "time step", "peak contact force below 1 kHz").values == pytest.approx(
        [20.0] * 3
    )
    assert found.force_cutoff_hz == 1000.0


def test_stress_is_judged_on_patches_and_never_at_its_peak(tmp_path, monkeypatch, asked):
    """A patch errs with the square of the element size; the peak grows by a third with every
    halving, as at a sharp corner."""

    def execute(run, progress=None, threads=None, **kept):
        if run.fidelity == "lowfi":
            return stub.motion(run)
        size = 1e3 * run.numerics.element_size
        gauge = np.zeros((601, 2, 6))
        gauge[:, 1, 0] = 1e6 * (5.0 + 1e-3 * size**2)
        return stub.motion(
            run, wall_stress=gauge, stress={"peak_stress_pa": 1e7 * 0.75 ** math.log2(size)}
        )

    monkeypatch.setattr(store_module, "execute", execute)
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    written = convergence.run(study)
    found = written.result
    patch = stub.row(found, "element size", "patch stress below 1 kHz")
    assert (patch.unit, patch.order) == ("MPa", pytest.approx(2.0, abs=1e-6))
    assert patch.uncertainty == pytest.approx(1.25 * 0.016, rel=1e-6)
    peak = stub.row(found, "element size", "peak stress of the rail")
    assert (peak.uncertainty, peak.nominal_uncertainty, peak.gci_percent) == (
        None,
        None,
        None,
    )
    assert peak.order < 0.0 and "mesh-dependent" in peak.method
    shown = document.markdown(page.draw(written.result))
    assert "patch stress below 1 kHz" in shown and "mesh-dependent" in shown


def test_the_peak_is_judged_on_a_fillet_and_joints(tmp_path, monkeypatch, asked):
    """It errs with the square of the element size here. Control: with a fillet alone, with joints
    alone, and on a rail from a file no uncertainty is stated."""

    def execute(run, progress=None, threads=None, **kept):
        if run.fidelity == "lowfi":
            return stub.motion(run)
        size = 1e3 * run.numerics.element_size
        return stub.motion(run, stress={"peak_stress_pa": 1e6 * (5.0 + 1e-3 * size**2)})

    monkeypatch.setattr(store_module, "execute", execute)
    joints = {"rail.mount_stiffness.normal": 1e13, "rail.mount_stiffness.shear": 5e12}
    scene = scenes.load("tiny").replace({f"pads.{pad}.inset": 10e-3 for pad in range(8)})
    smooth = scene.replace({"rail.fillet": 2e-3} | joints)
    found = convergence.run(Study(smooth, tmp_path / "tiny", defaults("tiny"))).result
    peak = stub.row(found, "element size", "peak stress of the rail")
    assert (peak.order, peak.method) == (pytest.approx(2.0, abs=1e-6), "GCI")
    assert peak.uncertainty == pytest.approx(1.25 * 0.016, rel=1e-6)
    assert stresses.has_limit(smooth) and stresses.has_limit(scenes.load("reference"))
    for other in (scene.replace({"rail.fillet": 2e-3}), scene.replace(joints)):
        assert not stresses.has_limit(other)
    assert not any(stresses.has_limit(scenes.load(name)) for name in ("clamped", "channel"))
