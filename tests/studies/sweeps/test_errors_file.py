"""Sweeps of the errors of a file: their largest sizes in closed form, and the rates of a free payload."""

import math

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.studies import free_flight
from tipoff.faults import SceneError
from tipoff.scenes import load
from tipoff.studies.cli import app
from tipoff.studies.render.document import terminal
from tipoff.studies.sensitivity.options import SensitivityOptions
from tipoff.studies.sweeps import factors, page
from tipoff.studies.sweeps import stage as sweeps
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study

DIRECTION = """
[vary."thrust_offset.eccentricity.radial"]
distribution = "uniform"
low = "0 deg"
high = "360 deg"
"""
POLAR = (
    """
[vary."thrust_offset.eccentricity.axial"]
distribution = "rayleigh"
scale = "0.2 mm"
"""
    + DIRECTION
)
COMPONENTS = """
[vary."mass_offset.eccentricity.y"]
distribution = "uniform"
low = "-3 mm"
high = "1 mm"
[vary."mass_offset.eccentricity.z"]
distribution = "fixed"
value = "-4 mm"
"""
MASS = """
[factor."payload.mass"]
distribution = "uniform"
low = "0.9"
high = "1.1"
"""


def written(folder, text):
    path = folder / "errors.toml"
    path.write_text(text)
    return str(path)


def test_largest_sizes(tmp_path):
    """In two digits: 99.9 % of a Rayleigh distribution, and the farthest corner of two components."""
    found = factors.of_file(written(tmp_path, POLAR + COMPONENTS + MASS), load("reference"))
    thrust, mass = found
    assert (thrust.name, mass.name) == ("thrust_eccentricity", "mass_eccentricity")
    assert thrust.largest == pytest.approx(0.2 * math.sqrt(-2.0 * math.log(1e-3)), rel=0.05)
    assert mass.largest == 5.0 and mass.sizes[[0, -1]] == pytest.approx([0.5, 5.0])
    assert all(factor.largest == 1.0 for factor in factors.FACTORS)


def test_a_factor_of_the_value_of_the_scene(tmp_path):
    table = """
[factor."thrust_offset.misalignment.axial"]
distribution = "uniform"
low = "0.5"
high = "2"
"""
    scene = load("reference").replace({"thrust_offset.misalignment.axial": "0.3 deg"})
    (factor,) = factors.of_file(written(tmp_path, table), scene)
    assert factor.largest == pytest.approx(0.6)


def test_rates_of_a_free_payload_over_the_sizes_of_the_file(tmp_path, monkeypatch):
    """In proportion to the size, at all sizes; with no other error."""
    monkeypatch.setattr(sweeps.drawing, "figures", lambda _: [])
    study = Study(free_flight.scene(), tmp_path / "out", Settings(workers=1))
    vary = written(tmp_path, POLAR + MASS)
    found = sweeps.run(study, SensitivityOptions(vary=vary, sweep=8)).result
    for launch in found.launches:
        (factor,) = launch.factors
        exact = 1e-3 * free_flight.RATE_PER_METRE * np.array(factor.sizes)
        assert np.array(factor.largest["rate_deg_s"]) == pytest.approx(exact, rel=5e-3)
        assert factor.sizes[-1] == 0.74
    shown = " ".join(terminal(page.draw(found)).split())
    assert vary in shown.replace(" ", "")
    # what is not swept, with its size, and how far the swept one goes
    assert found.held == {"payload.mass": "0.905 to 1.1 times"}
    assert "payload.mass 0.905 to 1.1 times" in shown and "thrust eccentricity 0.74 mm" in shown
    other = sweeps.run(study, SensitivityOptions(sweep=8)).result
    assert not other.held and "not swept" not in terminal(page.draw(other))
    written(tmp_path, POLAR.replace("0.2 mm", "0.4 mm"))
    again = sweeps.run(study, SensitivityOptions(vary=vary, sweep=8)).result
    assert again.launches[0].factors[0].sizes[-1] == 1.5


def test_a_file_without_such_an_error_is_refused(tmp_path):
    vary = written(tmp_path, MASS)
    with pytest.raises(SceneError, match="payload.mass"):
        factors.of_file(vary, load("reference"))
    arguments = ["sensitivity", "--sweep", "8", "--out", str(tmp_path / "out"), "--vary", vary]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2 and "thrust_offset.misalignment" in result.stderr
    assert not (tmp_path / "out").exists()
