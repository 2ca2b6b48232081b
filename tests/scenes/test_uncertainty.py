"""Files of errors: components of offsets, factors of the values of the scene, and what is refused."""

import math

import numpy as np
import pytest
from typer.testing import CliRunner

from tipoff.faults import SceneError
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.scenes import halving, load, uncertainty
from tipoff.scenes.effects.mass_offset import Eccentricity
from tipoff.scenes.effects.thrust_offset import Misalignment
from tipoff.studies.cli import app
from tipoff.studies.sensitivity import tolerances


def normal(mean, sd):
    return {"distribution": "normal", "mean": mean, "sd": sd}


def read(scene="tiny", cases=50, **kinds):
    return uncertainty.parse({"cases": cases, **kinds}, load(scene))


def test_components_are_those_of_the_tables_of_the_scene():
    """A mass centre of 19 +- 2 mm along y and z, and a misalignment about a known direction: the numbers
    that are drawn come back from the tables that the models read."""
    vary = {
        "mass_offset.eccentricity.y": normal("19 mm", "2 mm"),
        "mass_offset.eccentricity.z": normal("-5 mm", "1 mm"),
        "thrust_offset.misalignment.y": normal("0.1 deg", "0.01 deg"),
        "thrust_offset.misalignment.z": normal("0 deg", "0.02 deg"),
    }
    errors = read(cases=2000, vary=vary)
    source = Drawn(errors)
    assert source.keys == [
        f"{table}.{name}"
        for table in ("mass_offset.eccentricity", "thrust_offset.misalignment")
        for name in ("axial", "radial")
    ]
    rows = source.rows(0, 2000)
    centres = np.array([_offset(row) for row in rows])
    assert np.allclose(centres.mean(axis=0), (0.0, 19e-3, -5e-3), atol=3e-4)
    assert np.allclose(centres.std(axis=0), (0.0, 2e-3, 1e-3), rtol=0.1)
    directions = np.array([_direction(row) for row in rows])
    assert np.allclose(directions[:, 1].mean(), math.radians(0.1), rtol=0.02)
    assert np.allclose(directions[:, 2].std(), math.radians(0.02), rtol=0.1)
    assert source.rows(7, 9) == rows[7:9]  # the same bits in any part
    assert list(halving.tolerances(errors)) == [
        "mass_offset.eccentricity",
        "thrust_offset.misalignment",
    ]
    half = Drawn(halving.halved(errors, "mass_offset.eccentricity")).rows(0, 2000)
    moved = np.array([_offset(row) for row in half])
    middle = np.array([0.0, 19e-3, -5e-3])
    assert np.allclose(moved, middle + 0.5 * (centres - middle), atol=1e-12)
    words = halving.words(errors, "mass_offset.eccentricity")
    assert words == "y 15.1 to 22.9 mm, z -6.96 to -3.04 mm"


def _offset(row):
    size, angle = (row[f"mass_offset.eccentricity.{name}"] for name in ("axial", "radial"))
    return Eccentricity.model_construct(axial=size, radial=angle).offset()


def _direction(row):
    size, angle = (row[f"thrust_offset.misalignment.{name}"] for name in ("axial", "radial"))
    return Misalignment.model_construct(axial=size, radial=angle).direction()


def test_a_component_that_does_not_vary_is_that_of_the_scene():
    scene = load("tiny").replace(
        {"mass_offset.eccentricity.axial": 5e-3, "mass_offset.eccentricity.radial": 0.0}
    )
    vary = {"mass_offset.eccentricity.y": normal("0 mm", "1 mm")}
    (row, *_) = Drawn(uncertainty.parse({"vary": vary}, scene)).rows(0, 1)
    _, y, z = _offset(row)
    assert y != 0.0 and z == pytest.approx(5e-3)


def test_a_factor_multiplies_the_value_of_the_scene():
    scene = load("tiny")
    errors = read(
        factor={"thrust.peak": normal("1", "0.02")}, vary={"payload.mass": normal("9.9 kg", "1 g")}
    )
    drawn = Drawn(errors)
    peaks = np.array([row["thrust.peak"] for row in drawn.rows(0, 50)]) / scene.thrust.peak
    assert 0.01 < peaks.std() < 0.03 and abs(peaks.mean() - 1.0) < 0.01
    stated = drawn.identity["vary"]
    assert stated["thrust.peak"]["factor_of"] == scene.thrust.peak
    assert "factor_of" not in stated["payload.mass"]
    assert halving.words(errors, "thrust.peak") == "0.961 to 1.04 times"
    listed = halving.listed(halving.sizes(errors))
    assert listed == "payload.mass 9.9 to 9.9 kg, thrust.peak 0.961 to 1.04 times"
    assert not uncertainty.far_from_scene(errors, scene)


CENTRE, SMALL = "mass_offset.eccentricity.", normal("1 mm", "0.1 mm")


@pytest.mark.parametrize(
    "kinds, words",
    [
        (
            {
                "vary": {
                    "mass_offset.eccentricity.y": normal("0 mm", "1 mm"),
                    "mass_offset.eccentricity.axial": normal("1 mm", "0.1 mm"),
                }
            },
            "axial and radial, or y and z",
        ),
        (
            {
                "factor": {"thrust.peak": normal("1", "0.1")},
                "vary": {"thrust.peak": normal("6 kN", "1 N")},
            },
            "one of both",
        ),
        ({"factor": {"thrust.peak": normal("6 kN", "1 N")}}, "factor.thrust.peak.mean"),
        ({"factor": {"gravity.z": normal("1", "0.1")}}, "a key that has a number in the scene"),
        ({"vary": {CENTRE + "y": SMALL, CENTRE + "axial": SMALL}}, "axial and radial, or y and z"),
        (
            {
                "factor": {"thrust.peak": normal("1", "0.1")},
                "vary": {"thrust.peak": normal("6 kN", "1 N")},
            },
            "one of both",
        ),
        ({"factor": {"thrust.peak": normal("6 kN", "1 N")}}, "factor.thrust.peak.mean"),
        ({"factor": {"gravity.z": normal("1", "0.1")}}, "a key that has a number in the scene"),
        ({"vary": {"mass_offset.eccentricity.x": normal("0 mm", "1 mm")}}, "no such key"),
        ({}, "at least one key that varies"),
    ],
)
def test_faults_name_the_key(kinds, words):
    with pytest.raises(SceneError, match=words):
        read(**kinds)


def test_a_component_far_from_the_scene_is_said():
    """Control: near it, nothing is said."""
    scene = load("tiny")
    for mean, said in (("19 mm", True), ("0 mm", False)):
        vary = {f"mass_offset.eccentricity.{axis}": normal(mean, "1 mm") for axis in "yz"}
        found = uncertainty.far_from_scene(uncertainty.parse({"vary": vary}, scene), scene)
        assert bool(found) is said and all("mass_offset.eccentricity.y" in found[0] for _ in found)


def test_sobol_indices_take_the_same_file(tmp_path):
    """With the numbers of the draws, which they do not need, and a name of the catalogue."""
    path = tmp_path / "errors.toml"
    path.write_text(
        """cases = 100
seed = 3
[factor."thrust.peak"]
distribution = "normal"
mean = "1"
sd = "0.02"
[vary."mass_offset.eccentricity.y"]
distribution = "normal"
mean = "0 mm"
sd = "0.1 mm"
"""
    )
    scene = load("tiny").replace(
        {"mass_offset.eccentricity.axial": 5e-3, "mass_offset.eccentricity.radial": 0.0}
    )
    own = tolerances.load(path, scene)
    point = np.full((1, len(own.inputs)), 0.8)
    (row,) = own.rows(point)
    read_there = uncertainty.load(path, scene)
    drawn = {key: item.ppf(np.array([0.8])).tolist() for key, item in read_there.vary.items()}
    there = {key: column[0] for key, column in read_there.overrides(drawn).items()}
    assert row == pytest.approx(there)
    assert len(tolerances.load("paper", scene).inputs) == 6


@pytest.mark.parametrize("name", ["paper", "reference", "vary/cubesat_3u"])
def test_a_file_of_the_catalogue_is_shown(name):
    found = CliRunner().invoke(app, ["scenes", "--show", name])
    assert found.exit_code == 0 and 'description = "' in found.stdout
    assert ("[vary." in found.stdout) == (name != "reference")
    refused = CliRunner().invoke(app, ["scenes", "--show", "papers"])
    assert refused.exit_code == 2 and "paper" in refused.stderr
