"""The whole pipeline on the scene made for it: one command, every result file, one page; and a
second call that does nothing."""

import json
import os
import re
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.studies.agreement.made import context
from tests.written_names import RUN_ROW
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import load
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.effects import friction
from tipoff.studies.ablation import stage as ablation
from tipoff.studies.agreement import interface
from tipoff.studies.agreement.candidates import compliant, on_coarse
from tipoff.studies.cli import app
from tipoff.studies.registry import QUESTIONS, results
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

# Minutes of runs and compilation. With the folder of a report that was made already, in
# TIPOFF_REPORT, nothing is computed again.
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1500)]

SECTIONS = (
    "answer",
    "scene",
    "mesh",
    "compliance",
    "thrust",
    "figure6",
    "contact-forces",
    "energy",
    "stress",
    "calibration",
    "agreement",
    "growth-section",
    "speedup",
    "cost",
    "ablation",
    "promises",
    "colophon",
)


@pytest.fixture(scope="module")
def pipeline(tmp_path_factory):
    """(folder of results, outcome of the first call, outcome of the second, seconds it took)."""
    made = os.environ.get("TIPOFF_REPORT")
    out = Path(made).resolve() if made else tmp_path_factory.mktemp("out")
    arguments = ["report", "--scene", "tiny", "--out", str(out)]
    with pytest.MonkeyPatch.context() as patch:
        # Each effect taken away is one more kernel to compile; one of them shows that the stage
        # works.
        if not made:
            patch.setattr(ablation, "EFFECTS", (friction.EFFECT,))
        first = CliRunner().invoke(app, arguments, catch_exceptions=False)
        started = time.monotonic()
        second = CliRunner().invoke(app, arguments, catch_exceptions=False)
        return out / "tiny", first, second, time.monotonic() - started


def result(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def test_first_call_succeeds(pipeline):
    _, first, _, _ = pipeline
    assert first.exit_code == 0, first.stderr


def test_second_call_does_nothing_and_is_quick(pipeline):
    _, _, second, seconds = pipeline
    assert second.exit_code == 0
    lines = second.stderr.strip().splitlines()
    made = [item for item in results() if item.stored is None]
    assert len(lines) == len(made) + 1 and all(line.endswith("nothing changed") for line in lines)
    assert seconds < 5.0


@pytest.mark.parametrize("fidelity", ["highfi", "lowfi"])
def test_runs_hold_the_keys_other_tools_read(pipeline, fidelity):
    rows = result(pipeline[0], fidelity)["conditions"]
    assert [row["condition"] for row in rows] == ["phi15", "phi60", "h1", "h2"]
    extra = (
        {"elements", "ns_per_element_step", "ns_per_element_stepped"}
        if fidelity == "highfi"
        else set()
    )
    for row in rows:
        assert RUN_ROW | extra <= set(row)
        assert row["status"] == "exited"
        assert len(row["settled"]["velocity_m_s"]) == len(row["settled"]["rate_deg_s"]) == 3
        expected = "finite-elements" if fidelity == "highfi" else "compliant"
        assert row["model"] == Trajectory.load(pipeline[0] / row["trajectory"]).model == expected
        if fidelity == "highfi":
            assert (
                0.0 < row["peak_stress_pa"] < row["yield_strength_pa"]
                and len(row["peak_stress_place_m"]) == 3
            )


def test_agreement_has_rows_of_all_conditions(pipeline):
    found = result(pipeline[0], "agreement")
    assert [row["condition"] for row in found["fitted"]] == ["phi15", "phi60"]
    assert [row["condition"] for row in found["held_out"]] == ["h1", "h2"]
    assert len(found["uncalibrated"]) == len(found["compliant"]) == len(found["modal"]) == 4
    for speed in (found["speedup"], found["speedup_compliant"]):
        assert speed["low"] <= speed["ratio"] <= speed["high"]
        assert speed["repeats_identical"]


def test_compliant_contact_needs_no_fit(pipeline):
    """Closer than the fit even on what that was fitted to; control: a compliance known by mean
    pressures alone is farther off."""
    found = result(pipeline[0], "agreement")
    fitted = {row["condition"]: row["rate_relative_l2"] for row in found["fitted"]}
    compliant = {row["condition"]: row["rate_relative_l2"] for row in found["compliant"]}
    simpler = {
        row["condition"]: row["rate_relative_l2"]
        for row in found["simpler"]
        if row["walls"] == "mean pressure"
    }
    assert all(
        compliant[name] < 0.02
        and compliant[name] < fitted[name]
        and compliant[name] < simpler[name]
        for name in fitted
    )
    assert result(pipeline[0], "compliance")["stations"] >= 2


def test_both_models_move_alike_with_the_interface_stiffness_they_share(pipeline, tmp_path):
    """And agree at each value, on the same mesh. Control: neither stays where it was. The study leaves
    the condition out, because its reference is not converged on so coarse a mesh."""
    assert result(pipeline[0], "agreement")["interface"] == []
    study = Study(load("tiny"), tmp_path, defaults("tiny"))
    (name,) = study.scene.agreement.refined
    (static,) = on_coarse(study, [compliant(study, [name])]).values()
    found = interface.rows(study, static.request, context())
    assert [(row.condition, row.factor) for row in found] == [
        (name, factor) for factor in (0.25, 1.0, 4.0)
    ]
    for row in found:
        moved = row.reference_change_deg_s
        assert row.surrogate_change_deg_s == pytest.approx(moved, rel=0.5)
        assert (moved > 0.0) == (row.factor != 1.0)
        assert row.settled_rate_error_deg_s < 0.1


def test_calibration_brings_the_fitted_conditions_closer(pipeline):
    """Fitted on these, so anything else would be a fault of the search; the held-out ones promise
    nothing on so coarse a mesh."""
    found = result(pipeline[0], "agreement")
    before = {row["condition"]: row["rate_relative_l2"] for row in found["uncalibrated"]}
    after = {row["condition"]: row["rate_relative_l2"] for row in found["fitted"]}
    assert sum(after.values()) < sum(before[name] for name in after)
    calibration = Calibration.load(pipeline[0] / "calibration.toml")
    assert calibration.conditions == ["phi15", "phi60"]
    assert calibration.constants == result(pipeline[0], "calibration")["constants"]


def test_cost_has_three_meshes_and_three_tolerances(pipeline):
    points = result(pipeline[0], "cost")
    assert points == result(pipeline[0], "cost_study")["points"]
    counts = [
        sum(point["model"] == model for point in points)
        for model in (
            "finite-elements",
            "springs, uncalibrated",
            "springs, calibrated",
            "compliant, mean pressure of each face by itself",
            "compliant",
            "compliant, 4 modes",
        )
    ]
    assert all(count >= 3 for count in counts)
    assert [point["numerics"] for point in points if point["modes"]] == [
        "1 mode",
        "2 modes",
        "8 modes",
        "degree 2, 20 modes",
        "degree 5, 20 modes",
    ]
    assert len(result(pipeline[0], "cost_study")["matched"]) == 5
    assert any(point["pareto"] for point in points)


def test_growth_of_a_micrometre_in_both_models(pipeline):
    """Both on the condition of the floor at least, whose figure it must repeat."""
    found = result(pipeline[0], "agreement")
    models = {(item["condition"], item["model"]): item for item in found["growth"]}
    floor = {
        item["model"]: item["settled_rate_change_deg_s"]
        for item in found["floor"]
        if item["condition"] == "phi15"
    }
    for model, named in (("finite-elements", "reference"), ("compliant", "compliant")):
        item = models["phi15", model]
        assert item["settled_separation_deg_s"] == floor[named] and item["contacts"]
        assert (
            len(item["time_s"]) == len(item["separation_deg_s"])
            and max(item["separation_deg_s"]) > 0.0
        )


def test_ablation_changes_rates_and_kernel(pipeline):
    rows = {
        (row["fidelity"], row["variant"]): row for row in result(pipeline[0], "ablation")["rows"]
    }
    for fidelity in ("highfi", "lowfi"):
        assert max(map(abs, rows[fidelity, "without friction"]["settled_rate_change_deg_s"])) > 0.01
    assert "friction" in rows["highfi", "all effects"]["evaluated"]
    assert "friction" not in rows["highfi", "without friction"]["evaluated"]


def test_page_is_whole_and_self_contained(pipeline):
    page = (pipeline[0] / "report.html").read_text()
    assert [name for name in SECTIONS if f'id="{name}"' not in page] == []
    # studies with targets of their own
    (line,) = re.findall(r"Not made: ([^.]*)\.", page)
    assert len(line.split(", ")) >= len(QUESTIONS) and "BROKEN" not in page
    assert page.count("/*! For license information") <= 1 and 'src="http' not in page
    figures = {path.name for path in (pipeline[0] / "figures").glob("*.png")}
    assert {
        "compliance.png",
        "thrust.png",
        "figure6.png",
        "contact-forces.png",
        "energy-ledgers.png",
        "cost.png",
        "growth.png",
    } <= figures


def test_blind_conditions_are_judged_beside_what_was_made(pipeline):
    """Two conditions drawn afterwards, on the calibration and the compliance of the pipeline, which
    are not made again."""
    out = str(pipeline[0].parent)
    fitted = (pipeline[0] / "calibration.toml").stat().st_mtime_ns
    found = CliRunner().invoke(
        app,
        ["compare", "--scene", "tiny", "--out", out, "--blind", "2", "--seed", "5"],
        catch_exceptions=False,
    )
    assert found.exit_code == 0 and "2 conditions drawn with seed 5" in found.stdout
    kept = result(pipeline[0], "blind")
    assert (
        [row["condition"] for row in kept["compliant"]]
        == ["blind1", "blind2"]
        == [row["condition"] for row in kept["calibrated"]]
    )
    assert {row["role"] for row in kept["compliant"]} == {"held_out"}
    assert (pipeline[0] / "calibration.toml").stat().st_mtime_ns == fitted


@pytest.mark.parametrize("condition", ["phi15", "h1", "nominal"])
def test_a_model_is_chosen_from_what_the_pipeline_measured(pipeline, condition):
    """Nothing is fitted again, and the model runs as it was measured: compliant, where it was."""
    folder = pipeline[0]
    before = (folder / "calibration.json").read_bytes()
    asked = [
        "run",
        "--scene",
        "tiny",
        "--condition",
        condition,
        "--budget",
        "1 h",
        "--json",
        "--out",
        str(folder.parent),
    ]
    told = CliRunner().invoke(app, asked, catch_exceptions=False)
    assert told.exit_code == 0, told.stderr
    found = json.loads(told.stdout)
    assert found["condition"] == condition
    assert ("-compliant" in found["trajectory"]) == (
        found["chosen"]["rung"] in ("along", "compliant", "modal")
    )
    assert ("errors on h1 from tipoff compare" in found["chosen"]["why"]) == (condition == "h1")
    assert ("none are measured on nominal" in found["chosen"]["why"]) == (condition == "nominal")
    assert (folder / "calibration.json").read_bytes() == before
