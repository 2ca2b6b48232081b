"""The limit that justifies the surrogate: with the interface stiffness of the reference and rigid
walls it is the reference with an infinitely stiff rail.

The deflection of a rail of modulus E is proportional to 1/E, and so is its effect on a smooth
event, until the effect of interface stiffness, step or quadrature is larger. The interface
stiffness is a hundredth of the catalogue's or less, so that a rail is stiff beside it; pads are
flat and lie on whole facets."""

import dataclasses

import numpy as np
import pytest

from tests.exact import guided as exact
from tipoff import highfi, lowfi, scenes

STIFFER = (4.0, 16.0, 64.0)
DURATION, APPROACH = 6e-3, 0.01  # s, m/s
SPEED = 5.0  # m/s
# m/s2: at 1 g the pads tilt by 16 mrad, and the directions of a force on an edge may differ by that
G = 9.80665 / 50.0


def launcher(
    stiffer: float,
    interface_stiffness: float,
    duration: float,
    initial: dict,
    pad_at: float | None = None,
    **other,
) -> scenes.Scene:
    """A payload without thrust or friction on a fixed platform, its pads ``pad_at`` (m) from the
    mass centre if not where they are."""
    scene = scenes.load("reference")
    raw = {
        key: value
        for key, value in scene.resolved().items()
        if key in ("payload", "rail", "output")
    }
    raw["payload"] |= other.pop("payload", {})
    raw["rail"]["material"]["youngs_modulus"] *= stiffer
    # Edges of the pads on borders of facets, where no Gauss point is in doubt.
    raw["pads"] = [
        pad.model_dump(mode="json") | {"relief": 0.0, "inset": 0.01175} for pad in scene.pads
    ]
    for pad in raw["pads"] if pad_at else []:
        pad["position"][0] = float(np.copysign(pad_at, pad["position"][0]))
    raw["contact"] = scene.contact.model_dump(mode="json") | {
        "interface_stiffness": interface_stiffness
    }
    raw["thrust"] = {"kind": "constant", "force": 0.0, "duration": duration}
    return scenes.parse(
        raw | {"name": "stiff", "duration": duration, "initial": initial} | other,
        bare_numbers_are_si=True,
    )


def comes_against(start: float, stiffer: float) -> scenes.Scene:
    """Slides from X = ``start`` (m) and touches four walls."""
    return launcher(
        stiffer,
        1.8e10,
        DURATION,
        {"position": {"x": start, "z": 0.24e-3}, "velocity": {"x": SPEED, "z": APPROACH}},
    )


def tips_off(stiffer: float) -> scenes.Scene:
    """O30: rests on the lower walls, its front pads about to leave them, the rear ones 40 ms
    later."""
    interface_stiffness, area = 1.8e9, 0.016**2
    sunk = 20.0 * G / (4.0 * interface_stiffness * area)
    return launcher(
        stiffer,
        interface_stiffness,
        56e-3,
        {"position": {"x": 0.022, "z": -0.25e-3 - sunk}, "velocity": {"x": SPEED}},
        0.1,
        payload={"mass": 20.0, "inertia": {"xx": 0.8, "yy": 0.8, "zz": 0.8}},
        gravity={"z": -G},
    )


def apart(one, other) -> tuple[float, float]:
    """Differences of the velocity across and of the rates: of the rates as a velocity 0.1 m from
    the mass centre, both over what the velocity is."""
    count = min(len(one.time), len(other.time))
    size = np.linalg.norm(one.velocity[:count, 2])
    return (
        np.linalg.norm(one.velocity[:count, 2] - other.velocity[:count, 2]) / size,
        0.1 * np.linalg.norm(one.rate[:count] - other.rate[:count]) / size,
    )


def both(scene, quadrature: int = 4) -> tuple:
    """The reference, the surrogate on rigid walls, and on those of the same rail."""
    compliance = highfi.condense(scene, 0.004)
    at_rest = dataclasses.replace(compliance, flexibility=np.zeros_like(compliance.flexibility))
    numerics = highfi.Numerics(element_size=0.004, quadrature=quadrature)
    return (
        highfi.run(scene, numerics=numerics),
        lowfi.run(scene, compliance=at_rest),
        lowfi.run(scene, compliance=compliance),
    )


@pytest.mark.case("O52")
@pytest.mark.slow
@pytest.mark.parametrize(
    "event",
    [
        lambda stiffer: comes_against(0.0, stiffer),
        lambda stiffer: comes_against(0.03, stiffer),
        tips_off,
    ],
    ids=["straight slide", "front pads leave", "tip-off"],
)
def test_difference_of_the_fidelities_falls_with_the_stiffness_of_the_rail(event):
    runs = [both(event(stiffer)) for stiffer in STIFFER]
    rigid = [apart(reference, on_rigid) for reference, on_rigid, _ in runs]
    real = [apart(reference, on_walls) for reference, _, on_walls in runs]
    slopes = np.diff(np.log(rigid), axis=0) / np.diff(np.log(STIFFER))[:, None]
    assert (slopes < -0.8).all() and (slopes > -1.2).all()
    # Control: with the rail's own flexibility little is left of the difference, so it was the
    # flexibility that made it.
    assert (np.array(real[0]) < 0.1 * np.array(rigid[0])).all()
    if event is tips_off:
        expected = exact.tip_off(20.0, 0.8, 0.1, 0.2, SPEED, G)["rate"]
        # pads that sink by 21 um
        assert [run.outcome.rate[1] for run in runs[-1]] == pytest.approx([expected] * 3, rel=1e-2)


@pytest.mark.slow
def test_the_limit_ends_at_the_quadrature_of_the_reference():
    """On a rail a thousand times stiffer the difference of the rates is no longer proportional to
    1/E, with the rail's own compliance as with rigid walls; with four times as many Gauss points of
    a facet it is again."""
    stiff = {quadrature: both(comes_against(0.0, 1024.0), quadrature) for quadrature in (4, 8)}
    before = apart(*both(comes_against(0.0, 256.0))[:2])
    (velocity, rate), finer = (apart(*stiff[quadrature][:2]) for quadrature in (4, 8))
    floor = {
        quadrature: apart(reference, on_walls)[1]
        for quadrature, (reference, _, on_walls) in stiff.items()
    }
    assert (
        np.log(velocity / before[0]) / np.log(4.0) < -0.8 < np.log(rate / before[1]) / np.log(4.0)
    )
    assert rate < 2.0 * floor[4] and floor[8] < 0.3 * floor[4] and finer[1] < 0.8 * rate
