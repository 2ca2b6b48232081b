"""What each button or pad does in a run: when it leaves the rail, and its place in a file of the run."""

import numpy as np
import pytest
from typer.testing import CliRunner

import tipoff
from tests.lowfi.support import PAPER_PAD, corners, scene
from tipoff import lowfi
from tipoff.results import guides
from tipoff.results.trajectory import Trajectory
from tipoff.studies.cli import app

MASS, FORCE, END = 20.0, 4000.0, 0.2
RAIL = {
    "start": -1.0,
    "end": END,
    "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
}
PUSH = {"kind": "constant", "force": FORCE, "duration": 1.0}


def straight(interval: float) -> Trajectory:
    asked = scene(
        0.06, interval, mass=MASS, pads=corners(), rail=RAIL, thrust=PUSH, contact=PAPER_PAD
    )
    return lowfi.run(asked, "springs")


@pytest.mark.parametrize("interval", [5e-5, 1.1e-3])
def test_pads_leave_by_the_kinematics_of_a_constant_push(interval):
    """A trailing edge at x leaves at sqrt(2 s / a), s = end - x, at a times this time, for any sampling."""
    run, push = straight(interval), FORCE / MASS
    for guide in run.guides:
        way = END - (guide.place_m[0] - 0.008)
        at = np.sqrt(2.0 * way / push)
        assert guide.leaves_s == pytest.approx(at, rel=1e-9)
        assert guide.speed_m_s == pytest.approx(push * at, rel=1e-9)
        assert guide.rate_rad_s == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
        assert guide.largest_force_n is None and guide.force_n is None
    times = [guide.leaves_s for guide in run.guides]
    assert max(times) == pytest.approx(run.outcome.exit_time, rel=1e-9)
    assert min(times) < 0.8 * max(times)  # control: the pads do not leave together


def test_a_file_keeps_them(tmp_path):
    run = tipoff.run(tipoff.load("tiny"), "springs", sensitivity=False)
    run.save(tmp_path / "run.nc")
    read = Trajectory.load(tmp_path / "run.nc")
    assert read.guides == run.guides
    assert any(guide.largest_force_n for guide in read.guides)
    assert "guide_force" in run.to_xarray() and run.to_xarray().guide_force.attrs["units"] == "N"


def test_a_payload_that_stays_leaves_with_nothing():
    run = lowfi.run(scene(5e-3, 1e-3, mass=MASS, contact=PAPER_PAD), "springs")
    assert all(
        guide.leaves_s is None
        for guide in guides.of_run(tipoff.parse(run.scene, bare_numbers_are_si=True), run)
    )


def test_a_sensitive_run_prints_no_single_rates_of_its_buttons(tmp_path):
    """Its answer is a range. Control: with --explain they are there."""
    asked = ["run", "--scene", "rocket_rail", "--model", "springs", "--out", str(tmp_path)]
    for more, count in (([], 0), (["--explain"], 2)):
        found = CliRunner().invoke(app, [*asked, *more])
        assert found.exit_code == 0 and "the range is that of" in found.stdout
        lines = [line for line in found.stdout.splitlines() if line.startswith("  button ")]
        assert len(lines) == 2 and all(" m/s" in line for line in lines)
        assert sum("deg/s" in line for line in lines) == count
