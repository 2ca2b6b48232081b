"""The layer of a pad in series with the interface."""

from pathlib import Path

import numpy as np
import pytest

from tests.scenes.support import CONTACT, small
from tipoff.scenes import load, parse, scene_model

POLYMER = {"thickness": "5 mm", "youngs_modulus": "0.5 GPa"}
JOINT = 2e12


def scene(**layer):
    table = {**CONTACT, "interface_stiffness": f"{JOINT} N/m**3"}
    return parse(small(contact=table | ({"pad_layer": layer} if layer else {})))


def compression(modulus, nu, confined):
    """Modulus of compression (Pa) along x by Hooke's law in three dimensions, solved numerically:
    for strain along x alone, or for stress along x alone."""
    compliance = (np.eye(3) * (1.0 + nu) - nu) / modulus
    stiffness = np.linalg.inv(compliance)
    return stiffness[0, 0] if confined else 1.0 / compliance[0, 0]


@pytest.mark.case("O71")
@pytest.mark.parametrize("nu", [None, 0.0, 0.3, 0.46])
def test_layer_and_interface_are_springs_in_series(nu):
    """One metre squared under one pascal: the approaches add. Control: the interface alone is
    stiffer."""
    layer = POLYMER if nu is None else POLYMER | {"poisson_ratio": nu}
    found = scene_model.build(scene(**layer)).interface_stiffness
    approach = 1.0 / JOINT + 0.005 / compression(0.5e9, 0.3 if nu is None else nu, nu is not None)
    assert found == pytest.approx(1.0 / approach, rel=1e-12)
    assert found < 0.3 * JOINT == 0.3 * scene_model.build(scene()).interface_stiffness


def test_a_layer_that_cannot_bulge_is_stiffer_without_bound():
    """Towards the incompressible layer. Control: one that is free does not know Poisson's ratio."""
    stiff = [
        scene(**POLYMER, poisson_ratio=nu).contact.pad_layer.stiffness() for nu in (0.0, 0.4, 0.499)
    ]
    free = scene(**POLYMER).contact.pad_layer.stiffness()
    assert stiff[0] == free == pytest.approx(1e11)
    assert stiff[1] / free == pytest.approx(0.6 / (1.4 * 0.2)) and stiff[2] / free > 150.0


@pytest.mark.parametrize("layer", [{}, POLYMER, POLYMER | {"poisson_ratio": 0.4}])
def test_the_whole_stack_is_scaled(layer):
    """As the studies change it. Control: with a layer the interface alone changes little."""
    nominal = scene(**layer)
    for factor in (0.25, 4.0):
        changed = nominal.replace(nominal.contact.stiffened(factor)).contact.series_stiffness()
        assert changed == pytest.approx(factor * nominal.contact.series_stiffness(), rel=1e-12)
    alone = nominal.replace({"contact.interface_stiffness": 4.0 * JOINT})
    ratio = alone.contact.series_stiffness() / nominal.contact.series_stiffness()
    assert ratio < 1.2 if layer else ratio == 4.0


def test_no_layer_leaves_the_hash():
    """Control: a layer changes it."""
    layered = scene(**POLYMER)
    assert "pad_layer" not in scene().physics()["contact"]
    assert layered.replace({"contact.pad_layer": None}).hash == scene().hash != layered.hash


def test_an_implausibly_soft_layer_is_warned_of():
    """A modulus in MPa that was meant in GPa. Control: the polymer itself is plausible."""
    warned = [
        any(
            text.startswith("contact.pad_layer: under ")
            for text in load("reference")
            .replace({"contact.pad_layer": POLYMER | {"youngs_modulus": modulus}})
            .warnings
        )
        for modulus in ("0.5 MPa", "0.5 GPa")
    ]
    assert warned == [True, False]


def test_the_documented_numbers_follow_from_their_laws():
    """Every row of the two tables. Control: twice the hardness is out of their
    tolerance."""
    text = (Path(__file__).parents[3] / "docs/interface_stiffness.md").read_text()
    rows = [
        [float(cell) for cell in line.strip("| ").split("|")]
        for line in text.splitlines()
        if line.startswith("| ") and line[2].isdigit()
    ]
    asperities, layers = ([row for row in rows if len(row) == count] for count in (4, 5))
    assert (len(asperities), len(layers)) == (9, 5)

    def distance(roughness, pressure, hardness):
        return 1.53e-6 * roughness * (1e6 * pressure / hardness) ** -0.097

    for roughness, pressure, plastic, elastic in asperities:
        step = 1e-4 * pressure
        around = (distance(roughness, pressure + sign * step, 1.5e9) for sign in (-1.0, 1.0))
        closer = -float(np.diff(list(around))[0])
        assert plastic == pytest.approx(2e6 * step / closer, rel=0.03)
        assert elastic == pytest.approx(pressure / roughness * 1e12, rel=0.05)
        assert distance(roughness, pressure, 3e9) > 1.05 * distance(roughness, pressure, 1.5e9)
    for modulus, thickness, nu, free, confined in layers:
        layer = {"thickness": f"{thickness} mm", "youngs_modulus": f"{modulus} GPa"}
        assert scene(**layer).contact.pad_layer.stiffness() == pytest.approx(free, rel=0.03)
        held = scene(**layer, poisson_ratio=nu).contact.pad_layer.stiffness()
        assert held == pytest.approx(confined, rel=0.03)
