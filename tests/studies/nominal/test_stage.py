"""The answer of the scene itself and its range, from the runs and the ensemble to what is printed."""

import json
import math
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import tipoff
from tests.studies import free_flight
from tests.studies.shown import html
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.scenes.names import NOMINAL
from tipoff.studies.cli import app
from tipoff.studies.nominal import page, spread, stage
from tipoff.studies.single import single
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

TILT, MOST = math.radians(0.3), math.radians(0.4)  # of the scene itself, and at most of a launch
FILE = """cases = 10
seed = 3

[vary."thrust_offset.misalignment.axial"]
distribution = "uniform"
low = "0 deg"
high = "0.4 deg"
"""
LARGEST = MOST * free_flight.RATE_PER_RADIAN  # deg/s


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A launch in free flight, tilted by 0.3 deg; its errors are tilts of 0 to 0.4 deg, all alike."""
    folder = tmp_path_factory.mktemp("free")
    (folder / "tilt.toml").write_text(FILE)
    changes = {
        "studies.errors": str(folder / "tilt.toml"),
        "thrust_offset.misalignment.axial": TILT,
    }
    scene = free_flight.scene().replace(free_flight.BRIEF | changes)
    return Study(scene, folder / "out", Settings(element_size=0.016, workers=1))


def numbers(text: str) -> list[float]:
    """All numbers with a decimal point."""
    return [float(number) for number in re.findall(r"-?\d+\.\d+", text)]


def test_answer_and_range_of_a_launch_in_free_flight_are_those_of_the_closed_form(study):
    """In the result, and in the first figures of the page. Control: the range is not symmetric about the
    answer, so that no interval around it fits."""
    found = stage.run(study).result
    rate = free_flight.RATE_PER_RADIAN * math.sin(TILT)
    values = {"rate_deg_s": rate, "rate_x_deg_s": 0.0, "rate_y_deg_s": 0.0, "rate_z_deg_s": -rate}
    for model in (FINITE_ELEMENTS, COMPLIANT):
        answer = found.answer[model]
        assert {name: answer[name] for name in values} == pytest.approx(values, abs=2e-3 * rate)
    assert found.failed == () and found.spread.cases == spread.CASES[0]
    (total, words), *_ = page.figures(found)
    assert words.startswith("total rate; 95 % of launches: ") and total.endswith(" deg/s")
    low, high = numbers(words)
    assert (low, high) == pytest.approx((0.025 * LARGEST, 0.975 * LARGEST), abs=0.02 * LARGEST)
    (value,) = numbers(total)
    assert value == pytest.approx(rate, abs=0.02 * LARGEST)
    # Control:
    assert (rate - low) > 2.0 * (high - rate)
    assert html(page.draw(found)).index(total.split()[0]) < html(page.draw(found)).index("launches")


def test_the_range_that_run_prints_is_that_of_the_closed_form(study, capsys):
    """Under the answer of the run. Control: without errors in the scene, it says that none is known."""
    single.run(study, NOMINAL)
    found = single.ranged(study, NOMINAL)
    said = capsys.readouterr().out
    line = next(line for line in said.splitlines() if "95 % range, rate about Z" in line)
    exact = (-0.975 * LARGEST, -0.025 * LARGEST)
    assert numbers(line) == pytest.approx(exact, abs=0.02 * LARGEST)
    ends = found["spread"]["ranges"]["rate_z_deg_s"]
    assert numbers(line) == pytest.approx((ends["low"], ends["high"]), abs=0.02 * LARGEST)
    assert said.index("deg/s") < said.index("95 % range")
    # Control:
    plain = Study(study.scene.replace({"studies": None}), study.folder, study.settings)
    assert single.ranged(plain, NOMINAL) == {"spread": None}
    assert "no range is known" in capsys.readouterr().out


def total_rates(cases) -> np.ndarray:
    """Total rates (deg/s) of the cases that settled."""
    found = np.degrees(np.linalg.norm(cases.rate.values, axis=1))
    return found[np.isfinite(found)]


@pytest.mark.slow
def test_answer_and_range_of_a_small_launcher_are_those_of_its_runs(tmp_path):
    """``tipoff run --range`` and the stage, against runs and ensembles of the Python interface: the same
    launches have the same range, others with another seed have it within the bounds of its ends.
    Control: with twice the clearance it is outside them."""
    size, out = "16 mm", tmp_path / "out"
    elements = f"studies.element_size={size}"
    said = CliRunner().invoke(
        app, ["run", "--scene", "tiny", "--range", "--set", elements, "--out", str(out)]
    )
    assert said.exit_code == 0, said.stderr
    asked = [*("run", "--scene", "tiny", "--range", "--json"), "--set", elements]
    shown = json.loads(CliRunner().invoke(app, [*asked, "--out", str(out)]).stdout)
    scene = tipoff.load("tiny")
    study = Study(scene, out / "tiny", Settings(element_size=0.016, workers=1))
    found = stage.run(study).document
    assert found["spread"]["ranges"] == shown["spread"]["ranges"]
    compliance = tipoff.compliance(scene, size)
    alone = tipoff.run(scene, compliance=compliance).outcome
    rate = math.degrees(np.linalg.norm(alone.rate))
    assert found["answer"][COMPLIANT]["rate_deg_s"] == pytest.approx(rate, rel=1e-9)
    reference = tipoff.run(scene, "finite-elements", element_size=size).outcome
    rate = math.degrees(np.linalg.norm(reference.rate))
    assert found["answer"][FINITE_ELEMENTS]["rate_deg_s"] == pytest.approx(rate, rel=1e-9)
    ends, cases = found["spread"]["ranges"]["rate_deg_s"], found["spread"]["cases"]
    coarse = {"cells": 10, "degree": 2, "relative_tolerance": 2e-7}  # those of populations
    same = tipoff.ensemble(
        scene, "paper", compliance=compliance, count=cases, seed=found["spread"]["seed"], **coarse
    )
    quantiles = np.quantile(total_rates(same), [0.025, 0.975])
    # With the tolerance of steps that populations have, rates are within 0.2 % of these.
    assert (ends["low"], ends["high"]) == pytest.approx(tuple(quantiles), rel=2e-3)
    line = next(line for line in said.stdout.splitlines() if "95 % range, total rate" in line)
    assert numbers(line) == pytest.approx(tuple(quantiles), abs=0.02 * np.ptp(quantiles))

    def apart(other) -> float:
        """Distance of the worse end, in widths of its bounds."""
        low, high = np.quantile(total_rates(other), [0.025, 0.975])
        return max(
            abs(low - ends["low"]) / np.ptp(ends["low_bounds"]),
            abs(high - ends["high"]) / np.ptp(ends["high_bounds"]),
        )

    others = tipoff.ensemble(scene, "paper", compliance=compliance, count=cases, seed=977)
    assert apart(others) < 1.5  # four standard deviations of a difference are 1.4 widths
    # Control:
    wide = scene.replace({"contact.clearance": 2.0 * scene.contact.clearance})
    others = tipoff.ensemble(
        wide, "paper", compliance=tipoff.compliance(wide, size), count=cases, seed=977
    )
    assert apart(others) > 1.5
