"""Parameters become overrides and back, for every contact law, with and without friction."""

import pytest

from tests.calibration.support import SMALL
from tipoff import calibration, lowfi, scenes
from tipoff.calibration import parameters

REFERENCE = scenes.load("clamped")
IMPACT = dict(
    law="impact", clearance=0.25e-3, exponent=1.5, stiffness=2e9, damping=6e4, damping_depth=3e-4
)
LAWS = {
    "impact": IMPACT,
    "hunt-crossley": dict(
        law="hunt-crossley", clearance=0.25e-3, exponent=1.5, stiffness=2e9, dissipation=5.0
    ),
    "linear": dict(law="linear", clearance=0.25e-3, stiffness=2e7, damping=500.0),
}


def with_law(law: str, friction: bool = True) -> scenes.Scene:
    found = REFERENCE.replace({"contact": LAWS[law]})
    return found if friction else found.replace({"friction": "absent"})


@pytest.mark.parametrize("friction", [True, False])
@pytest.mark.parametrize("law", LAWS)
def test_a_scene_written_as_parameters_is_itself(law, friction):
    scene = with_law(law, friction)
    free = parameters.free(scene)
    changed = parameters.overrides(scene, {item.name: item.read(scene) for item in free})
    again = scene.replace(changed)
    for key, value in changed.items():
        table, name = key.split(".")
        assert getattr(getattr(again, table), name) == pytest.approx(
            getattr(getattr(scene, table), name), rel=1e-12
        ), (key, value)
    assert ("friction.dynamic" in [item.name for item in free]) == friction


@pytest.mark.parametrize("law", LAWS)
def test_shares_and_values_are_inverse_and_bounds_are_valid_scenes(law):
    scene = with_law(law)
    free = parameters.free(scene)
    for share in (0.0, 0.3, 1.0):
        for item in free:
            assert item.share(item.value(share)) == pytest.approx(share, abs=1e-12)
        scene.replace(parameters.overrides(scene, {item.name: item.value(share) for item in free}))


def test_stiffness_bounds_hold_the_rail_and_follow_it():
    """The reference rail gives 3e-8 to 1e-7 m/N (static finite elements), and bounds a tenth and
    ten times that."""
    force = parameters.free(REFERENCE)[0]
    assert force.lower / 2e-5 == pytest.approx(0.1 / 1e-7, rel=0.05)
    assert force.upper / 2e-5 == pytest.approx(10.0 / 3e-8, rel=0.05)
    soft = parameters.free(REFERENCE.replace({"rail.material.youngs_modulus": 7.2e9}))[0]
    assert soft.lower == pytest.approx(force.lower / 10.0)


def test_static_friction_keeps_its_ratio():
    scene = REFERENCE.replace({"friction.static": 0.3, "friction.dynamic": 0.2})
    values = {item.name: item.read(scene) for item in parameters.free(scene)} | {
        "friction.dynamic": 0.1
    }
    assert parameters.overrides(scene, values)["friction.static"] == pytest.approx(0.15)


def test_another_law_without_friction_has_its_own_parameters():
    free = parameters.free(with_law("hunt-crossley", friction=False))
    assert [item.name for item in free] == [
        "contact.force",
        "contact.exponent",
        "contact.dissipation",
    ]


@pytest.mark.slow
def test_another_law_without_friction_fits_its_own_curves():
    """Hunt-Crossley, start 40 % off in force; one condition of three impacts."""
    truth = with_law("hunt-crossley", friction=False).replace({"agreement.fitted": ["phi60"]})
    free = parameters.free(truth)
    wrong = {item.name: item.read(truth) for item in free}
    wrong["contact.force"] *= 1.4
    start = truth.replace(parameters.overrides(truth, wrong))
    found = calibration.run(
        start, {"phi60": lowfi.run(truth.condition("phi60"), "springs")}, plan=SMALL
    )
    assert found.parameters == ["contact.force", "contact.exponent", "contact.dissipation"]
    assert found.objective < 1e-7
    assert found.values[0] == pytest.approx(free[0].read(truth), rel=0.02)
    assert not [text for text in found.weak_directions if "held" in text]
