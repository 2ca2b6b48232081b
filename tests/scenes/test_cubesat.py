"""The scene ``cubesat_3u``: its public numbers, the exit speed by energy, and its errors."""

import math

import numpy as np
import pytest
from scipy.stats import ks_2samp

from tests.exact.spring import end_of_stroke
from tests.scenes.neighbours import both_models
from tipoff import highfi, lowfi
from tipoff.calibration import rail_compliance
from tipoff.scenes import load, uncertainty
from tipoff.studies.agreement import neighbours

SCENE = load("cubesat_3u")
# Typed here a second time on purpose, in SI, from the public documents.
MASS, SIZE, BOX = 4.0, (0.3405, 0.1, 0.1), 0.02
ELEMENTS, CHANGE = 0.016, 1e-6  # m; elements of both models, and the distance of neighbours
FRICTION = 6  # place of the friction in the ledger
FREE = {"contact": None, "friction": None, "mass_offset": None}


def test_the_public_numbers():
    """Mass, size, width across the rails and box of the mass centre of the specification; the pads are
    within the rails of 8.5 mm, and the way to the exit is the length of the CubeSat to 1 %."""
    assert (SCENE.payload.mass, SCENE.payload.size) == (MASS, pytest.approx(SIZE, rel=1e-12))
    xx = MASS * (SIZE[1] ** 2 + SIZE[2] ** 2) / 12.0
    yy = MASS * (SIZE[0] ** 2 + SIZE[2] ** 2) / 12.0
    inertia = SCENE.payload.inertia
    assert (inertia.xx, inertia.yy, inertia.zz) == pytest.approx((xx, yy, yy), rel=2e-3)
    for pad in SCENE.pads:
        assert tuple(map(abs, pad.position[1:])) == pytest.approx((0.05, 0.05), rel=1e-12)
        assert pad.inset + 0.5 * pad.width <= 8.5e-3 and pad.inset >= 0.5 * pad.width
    assert SCENE.rail.end - min(pad.position[0] - 0.5 * pad.length for pad in SCENE.pads) == (
        pytest.approx(SIZE[0], rel=0.02)
    )
    assert SCENE.thrust.arm == pytest.approx(0.5 * SIZE[0], rel=1e-12)
    assert all(
        scene.mass_offset is None or scene.mass_offset.eccentricity.axial <= BOX
        for scene in map(SCENE.condition, SCENE.conditions)
    )


def test_the_exit_speed_follows_from_energy():
    """Without the friction of the rails: the energy of the spring, less the friction of its pusher, moves
    CubeSat and pusher. Control: without the mass of the pusher the speed differs by 2 %."""
    (spring,) = SCENE.thrust.springs
    numbers = spring.preload, spring.rate, spring.stroke, (MASS, SCENE.platform.mass)
    run = lowfi.run(SCENE.replace(FREE), "springs")
    exact = end_of_stroke(*numbers, spring.friction, spring.mass)
    assert run.status == "exited"
    assert run.outcome.velocity[0] == pytest.approx(exact.payload, rel=1e-6)
    assert 1.0 < exact.payload < 2.0
    assert np.abs(run.outcome.rate).max() < 1e-9
    # Control:
    light = end_of_stroke(*numbers, spring.friction)
    assert abs(light.payload / exact.payload - 1.0) > 0.015


def test_the_rails_take_energy_and_limit_the_rates():
    """With rails the CubeSat is slower, by their friction, and it turns less than by the moment impulse of
    the spring about its mass centre. Control: without rails it turns more, because a push from behind
    turns it further."""
    free = lowfi.run(SCENE.replace(FREE), "springs").outcome
    held = lowfi.run(SCENE, "springs").outcome
    loose = lowfi.run(SCENE.replace({"contact": None, "friction": None}), "springs").outcome
    assert 0.9 * free.velocity[0] < held.velocity[0] < free.velocity[0]
    arm = SCENE.mass_offset.eccentricity.axial
    impulse = MASS * free.velocity[0]
    turned = math.degrees(impulse * arm / SCENE.payload.inertia.yy)
    assert math.degrees(np.linalg.norm(held.rate)) < 0.5 * turned
    # Control:
    assert math.degrees(np.linalg.norm(loose.rate)) > turned


def test_the_errors_are_inputs_of_the_scene():
    """Every error of the file varies in the scene, and the mass centre stays in the box. The file is that
    of the studies of the scene."""
    assert SCENE.studies.errors == "cubesat_3u"
    found = uncertainty.load("cubesat_3u", SCENE)
    largest = found.vary["mass_offset.eccentricity.axial"].ppf(np.array([1.0 - 1e-12]))[0]
    assert largest <= BOX * (1.0 + 1e-9)
    assert all(item.provenance for item in found.vary.values())


@pytest.mark.slow
def test_a_launch_of_the_reference_is_among_those_of_the_surrogate(tmp_path):
    """One run of the reference among twelve neighbours of the surrogate within 1 µm, on the same elements
    of 16 mm: exit speed, friction and total rate lie among them, with a margin of half their spread. A
    single launch is chaotic, so no closer comparison of one run is possible. Control: without friction the
    exit speed is outside."""
    scene = SCENE.condition("offset15")
    compliance = rail_compliance.kept(scene, tmp_path, ELEMENTS, lambda _: None)

    def values(run) -> np.ndarray:
        rate = math.degrees(np.linalg.norm(run.outcome.rate))
        return np.array([run.outcome.velocity[0], run.energy[-1, FRICTION], rate])

    found, low, high = both_models(scene, compliance, ELEMENTS, values)
    margin = 0.5 * (high - low)
    assert (low - margin < found).all() and (found < high + margin).all()
    # Control:
    free = lowfi.run(scene.replace({"friction": None}), "springs").outcome.velocity[0]
    assert free > high[0] + margin[0]


@pytest.mark.slow
@pytest.mark.parametrize("condition, other", [("offset5", "offset15"), ("offset15", "offset5")])
def test_both_models_have_like_launches(condition, other, tmp_path):
    """Eight runs of the reference and 96 of the surrogate, all within 1 µm of one launch and on the same
    elements of 16 mm: exit speed, rates and total rate have one distribution (Kolmogorov and Smirnov). A
    single launch is chaotic, so no comparison of one run is possible. Control: the exit speeds of the
    other condition, and those without friction, have another distribution."""
    compliance = rail_compliance.kept(
        SCENE.condition(condition), tmp_path, ELEMENTS, lambda _: None
    )

    def near(scene) -> np.ndarray:
        """Exit speed (m/s), rates and total rate (deg/s) of neighbours (n,5) of the surrogate."""
        numerics = lowfi.Numerics(modes=0)  # cells as in the reference: ten turn the payload faster
        drawn = neighbours.draw(scene, CHANGE, 96)
        found = lowfi.run_many(
            scene, drawn, "compliant", compliance=compliance, numerics=numerics, workers=1
        )
        return values(found["velocity"].values, found["rate"].values)

    scene = SCENE.condition(condition)
    changes = [{}, *scene.contact.either_way(CHANGE).values(), *neighbours.draw(scene, CHANGE, 5)]
    runs = [
        highfi.run(scene.replace(change), highfi.Numerics(element_size=ELEMENTS)).outcome
        for change in changes
    ]
    reference = values([run.velocity for run in runs], [run.rate for run in runs])
    for own, there in zip(reference.T, near(scene).T, strict=True):
        assert ks_2samp(own, there).pvalue > 0.02
    # Control:
    for apart in (SCENE.condition(other), scene.replace({"friction": None})):
        assert ks_2samp(reference[:, 0], near(apart)[:, 0]).pvalue < 1e-4


def values(velocity, rate) -> np.ndarray:
    """Speed (m/s), rates and total rate (deg/s) of launches (n,5)."""
    turning = np.degrees(rate)
    total = np.linalg.norm(turning, axis=1)
    return np.column_stack([np.array(velocity)[:, 0], turning, total])
