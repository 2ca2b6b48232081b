"""Constants of compliant contact: hidden values are found again from the surrogate's own curves, and
what the curves do not determine is named."""

import dataclasses

import numpy as np
import pytest
from typer.testing import CliRunner

import tipoff
from tests.calibration.noisy import inside
from tests.calibration.support import write_curves
from tests.highfi.support import tiny
from tests.lowfi.compliance import reference_compliance
from tipoff import calibration, highfi, lowfi, scenes
from tipoff.calibration import compliant, parameters
from tipoff.calibration.search import Plan
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import Calibration, SceneError
from tipoff.studies.cli import app
from tipoff.workspace import disturbed
from validation.recovery.draws import LOCAL

CONDITIONS = ("phi15", "phi35", "phi60")
SCENE = scenes.load("clamped").replace({"agreement.fitted": list(CONDITIONS)})
TRUTH = {
    "contact.interface_stiffness": 4.1e12,
    "contact.clearance": 0.262e-3,
    "friction.static": 0.13,
    "friction.dynamic": 0.13,
}
SMALL = Plan(points=32, starts=1, evaluations=80, polish=15)
ON_JOINTS = {
    "rail.mount_stiffness.normal": "1e13 N/m**3",
    "rail.mount_stiffness.shear": "5e12 N/m**3",
}


def curves(scene: scenes.Scene, compliance: RailCompliance) -> dict:
    """Of the fitted conditions, without modes of the rails, as calibration has none."""
    still = lowfi.Numerics(modes=0)
    return {
        name: lowfi.run(scene.condition(name), compliance=compliance, numerics=still)
        for name in scene.agreement.fitted
    }


def fitted(scene: scenes.Scene, plan: Plan) -> Calibration:
    compliance = reference_compliance()
    truth = curves(scene.replace(TRUTH), compliance)
    return calibration.run(scene, truth, plan=plan, compliance=compliance)


@pytest.fixture(scope="module")
def found():
    """By least squares from the scene's values, of one condition."""
    return fitted(SCENE.replace({"agreement.fitted": ["phi60"]}), LOCAL)


def test_hidden_values_are_found(found):
    """The information at the scene's values takes all three. Interface stiffness, 2.3 times the
    scene's, hardly shows in the curves: with model error it is known to a factor."""
    require_hidden_values(found)


@pytest.mark.slow
def test_hidden_values_are_found_by_a_search_of_all_values():
    require_hidden_values(fitted(SCENE, SMALL))


def require_hidden_values(found: Calibration) -> None:
    values = dict(zip(found.parameters, found.values))
    assert values["contact.clearance"] == pytest.approx(0.262e-3, rel=1e-5)
    assert values["friction.dynamic"] == pytest.approx(0.13, rel=1e-4)
    assert values["contact.interface_stiffness"] == pytest.approx(4.1e12, rel=1e-2)
    assert found.objective < 1e-8
    assert found.verdict == "the curves exclude the scene's values"
    assert inside(found.with_model_error, [4.1e12, 0.262e-3, 0.13]).all()
    low, high = found.with_model_error[0]
    assert high > 1.2 * low


def test_the_constants_run_on_the_model_they_were_fitted_to(found):
    compliance, scene = reference_compliance(), SCENE.condition("phi35")
    given = lowfi.run(scene, compliance=compliance, calibration=found)
    applied = lowfi.run(found.apply(scene), compliance=compliance)
    np.testing.assert_array_equal(given.rate, applied.rate)
    nominal = lowfi.run(scene, compliance=compliance)
    assert np.abs(nominal.rate - given.rate).max() > 1e-3
    with pytest.raises(SceneError, match="constants of compliant contact"):
        lowfi.run(scene, "springs", calibration=found)
    with pytest.raises(SceneError, match="constants of springs"):
        springs = parameters.overrides(SCENE, {"contact.force": 100.0})
        lowfi.run(scene, compliance=compliance, calibration=replaced(found, springs))


def replaced(found, constants):
    return dataclasses.replace(found, constants=constants)


def test_parameters_are_those_that_the_scene_has():
    names = [item.name for item in compliant.free(SCENE)]
    assert names == ["contact.interface_stiffness", "contact.clearance", "friction.dynamic"]
    bolted = SCENE.replace(ON_JOINTS | {"friction": "absent"})
    free = compliant.free(bolted)
    assert [item.name for item in free] == [*names[:2], "rail.mount_stiffness.factor"]
    for share in (0.0, 0.5, 1.0):
        values = {item.name: item.value(share) for item in free}
        again = bolted.replace(parameters.overrides(bolted, values))
        assert {item.name: item.read(again) for item in free} == pytest.approx(values, rel=1e-12)


def test_without_clearance_there_is_none_to_fit():
    scene = SCENE.replace({"contact.clearance": 0.0})
    names = [item.name for item in compliant.free(scene)]
    assert names == ["contact.interface_stiffness", "friction.dynamic"]


def test_a_compliance_of_another_model_is_refused():
    """Before any run: the model is the one that was named."""
    compliance = reference_compliance()
    with pytest.raises(SceneError, match="a rail compliance"):
        tipoff.calibrate(SCENE, {}, compliance=compliance)
    with pytest.raises(SceneError, match="no rail compliance"):
        tipoff.calibrate(SCENE, {}, model="compliant", compliance=compliance.rigid())


def test_rows_of_an_ensemble_vary_what_was_fitted(found):
    compliance = reference_compliance()
    row = {"contact.clearance": 0.24e-3}
    (rate,) = lowfi.run_many(SCENE, [row], compliance=compliance, calibration=found).rate.values
    alone = lowfi.run(found.apply(SCENE).replace(row), compliance=compliance).outcome.rate
    np.testing.assert_array_equal(rate, alone)


def test_constants_of_rigid_mounts_are_left_out(found):
    more = replaced(found, found.constants | {"rail.mount_stiffness.factor": 2.0})
    assert more.apply(SCENE).hash == found.apply(SCENE).hash


@pytest.mark.slow
def test_a_hidden_stiffness_of_the_mounts_is_found():
    """1.7 times the scene's, from one curve. Mounts and interface are springs in series, so that only
    what both give together is sure: every weak direction mixes them. So both are named: by
    information the fit would hold the mounts."""
    scene = SCENE.replace(ON_JOINTS | {"agreement.fitted": ["phi60"]})
    compliance = highfi.condense(scene, 0.008, joints=True)
    hidden = TRUTH | {"rail.mount_stiffness.factor": 1.7}
    plan = Plan(points=64, starts=2, evaluations=120, polish=20)
    truth = curves(scene.replace(hidden), compliance)
    free = ["rail.mount_stiffness.factor", "contact.interface_stiffness", "contact.clearance"]
    fit = [*free, "friction.dynamic"]
    found = calibration.run(scene, truth, fit=fit, plan=plan, compliance=compliance)
    values = dict(zip(found.parameters, found.values))
    assert values["rail.mount_stiffness.factor"] == pytest.approx(1.7, rel=0.02)
    assert values["contact.clearance"] == pytest.approx(0.262e-3, rel=1e-5)
    assert found.weak_directions
    for weak in found.weak_directions:
        assert "rail.mount_stiffness.factor" in weak and "contact.interface_stiffness" in weak


def test_the_command_fits_curves_and_others_run_with_the_file(tmp_path, monkeypatch):
    """The clearance of a run is the fitted one, also where its sensitivity is found. Control: without
    the file."""
    monkeypatch.setattr(calibration, "run", quick(calibration.run))
    hidden = tiny().replace({"contact.clearance": "0.2 mm"})
    file = write_curves(tmp_path / "test.csv", lowfi.run(hidden, compliance=tiny_compliance()))
    common = ["--scene", "tiny", "--out", str(tmp_path), "--set", "studies.element_size=8 mm"]
    fit = [
        "calibrate",
        *common,
        "--reference",
        str(file),
        "--fit",
        "contact.clearance, initial.position.y",
    ]
    said = call(*fit)
    path = tmp_path / "tiny/curves/calibration-compliant.toml"
    assert f"  {path}" in said.stdout and "the search, about" in said.stderr
    assert "initial.position.y" in said.stdout and "with model error" in said.stdout
    fitted = Calibration.load(path)
    clearances = []
    monkeypatch.setattr(
        disturbed, "execute", lambda run: clearances.append(run) or lowfi.run(run.scene, "springs")
    )
    assert (
        "model compliant, calibrated: exited"
        in call("run", *common, "--calibration", str(path)).stdout
    )
    changed = sorted(run.scene.contact.clearance for run in clearances)
    expected = fitted.constants["contact.clearance"] + np.array([-1e-6, 0.0, 1e-6])
    np.testing.assert_allclose(changed, expected, rtol=1e-12)
    assert all(run.calibration is None for run in clearances)
    assert "model compliant: exited" in call("run", *common).stdout
    cases = ["ensemble", *common[:4], "--cases", "20", "--calibration", str(path)]
    assert "compliant, calibrated" in call(*cases).stdout


def test_a_file_of_the_other_model_is_refused_before_the_compliance_is_found(tmp_path, found):
    path = tmp_path / "springs.toml"
    replaced(found, {"contact.stiffness": 1e9}).save(path)
    refused = call("run", "--scene", "tiny", "--out", tmp_path, "--calibration", path, code=2)
    assert (
        "given constants of springs, expected those of a fit on --model compliant" in refused.stderr
    )
    found.save(path)
    asked = ("run", "--scene", "tiny", "--out", tmp_path, "--calibration", path)
    refused = call(*asked, "--model", "springs", code=2)
    assert "given constants of compliant contact" in refused.stderr
    assert "rail compliance" not in refused.stderr


def test_faults_of_a_choice_come_before_any_run(tmp_path):
    asked = ("calibrate", "--scene", "tiny", "--out", tmp_path)
    refused = call(*asked, "--fit", "friction.static,contact.clearance", code=2)
    assert "'friction.static' is none of contact.interface_stiffness" in refused.stderr
    refused = call(*asked, "--fit", "contact.clearance", "--model", "springs", code=2)
    assert "expected none with springs" in refused.stderr


@pytest.mark.slow
def test_hidden_values_of_the_finite_elements_are_covered(tmp_path, monkeypatch):
    """Clearance and friction of a reference of 8 mm, on the compliance of the same mesh. Control: the
    intervals without model error miss."""
    monkeypatch.setattr(calibration, "run", quick(calibration.run, LOCAL))
    scene = tiny().replace(
        {"contact.clearance": 0.262e-3, "friction.dynamic": 0.13, "friction.static": 0.13}
    )
    files = []
    for name in ("phi15", "phi60"):
        run = tipoff.run(scene.condition(name), "finite-elements", element_size=8e-3)
        files += ["--reference", f"{name}={write_curves(tmp_path / name, run)}"]
    asked = [
        "calibrate",
        "--scene",
        "tiny",
        "--out",
        str(tmp_path),
        "--set",
        "studies.element_size=8 mm",
        *files,
    ]
    call(*asked, "--fit", "contact.clearance,friction.dynamic")
    found = Calibration.load(tmp_path / "tiny/curves/calibration-compliant.toml")
    assert inside(found.with_model_error, [0.262e-3, 0.13]).all()
    assert not inside(found.intervals, [0.262e-3, 0.13]).all()
    assert found.values[0] == pytest.approx(0.262e-3, rel=0.01)


def tiny_compliance() -> RailCompliance:
    return highfi.condense(tiny(), 0.008)


def call(*asked, code: int = 0):
    said = CliRunner().invoke(app, [str(word) for word in asked])
    assert said.exit_code == code, said.output
    return said


def quick(run, plan: Plan | None = None):
    """The search in a few evaluations: the command is tested, not the fit."""
    plan = plan or Plan(4, 1, 4, polish=1)
    return lambda *given, **named: run(*given, **named | {"plan": plan})
