"""A fit of one parameter: each parameter that a scene has, alone, from the scene's own curves."""

import functools

import pytest

from tests.lowfi.compliance import reference_compliance
from tipoff import calibration, highfi, lowfi, scenes
from tipoff.calibration import alignment, compliant
from tipoff.calibration.search import Plan
from tipoff.mechanics.rail_compliance import RailCompliance

SCENE = scenes.load("clamped").replace({"agreement.fitted": ["phi60"]})
QUICK = Plan(points=8, starts=2, evaluations=10, polish=4)
BOLTED = {
    "rail.mount_stiffness.normal": "1e13 N/m**3",
    "rail.mount_stiffness.shear": "5e12 N/m**3",
}
NAMES = [*compliant.KEYS, *alignment.NAMES]


@functools.cache
def bolted() -> tuple[scenes.Scene, RailCompliance]:
    scene = SCENE.replace(BOLTED)
    return scene, highfi.condense(scene, 8e-3, joints=True)


def require_own_value(scene: scenes.Scene, compliance: RailCompliance, name: str) -> None:
    run = lowfi.run(
        scene.condition("phi60"), compliance=compliance, numerics=lowfi.Numerics(modes=0)
    )
    found = calibration.run(scene, {"phi60": run}, plan=QUICK, compliance=compliance, fit=[name])
    assert found.parameters == [name] and found.objective < 1e-8
    if name not in compliant.KEYS:
        assert found.values == [0.0]


@pytest.mark.parametrize("name", ["contact.clearance", "thrust_offset.eccentricity.z"])
def test_one_parameter_is_fitted(name):
    require_own_value(SCENE, reference_compliance(), name)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_parameter_is_fitted_alone(name):
    require_own_value(*bolted(), name)
