"""The limit that justifies the surrogate: with the interface stiffness of the reference and rigid
walls it is the reference with an infinitely stiff rail.

The deflection of a rail of modulus E is proportional to 1/E, and so is its effect on a smooth
event, until the effect of interface stiffness, step or contact cells is larger. The interface
stiffness is a hundredth of the catalogue's or less, so that a rail is stiff beside it; pads are
flat."""

import dataclasses

import numpy as np
import pytest

from tests.exact import guided as exact
from tests.exact import planar
from tipoff import highfi, lowfi, scenes
from tipoff.mechanics import ledger

STIFFER = (4.0, 16.0, 64.0)
DURATION, APPROACH, TIP_OFF = 6e-3, 0.01, 56e-3  # s, m/s, s
SPEED = 5.0  # m/s
G = 9.80665  # m/s2


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
    scene = scenes.load("clamped")
    raw = {
        key: value
        for key, value in scene.resolved().items()
        if key in ("payload", "rail", "output")
    }
    raw["payload"] |= other.pop("payload", {})
    raw["rail"]["material"]["youngs_modulus"] *= stiffer
    raw["pads"] = [pad.model_dump(mode="json") | {"relief": 0.0} for pad in scene.pads]
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


def tips_off(stiffer: float, interface_stiffness: float = 1.8e9) -> scenes.Scene:
    """O30: rests on the lower walls, its front pads about to leave them, the rear ones 40 ms
    later."""
    sunk = 20.0 * G / (4.0 * interface_stiffness * 0.016**2)
    return launcher(
        stiffer,
        interface_stiffness,
        TIP_OFF,
        {"position": {"x": 0.022, "z": -0.25e-3 - sunk}, "velocity": {"x": SPEED}},
        0.1,
        payload={"mass": 20.0, "inertia": {"xx": 0.8, "yy": 0.8, "zz": 0.8}},
        gravity={"z": -G},
    )


def on_springs(interface_stiffness: float) -> planar.Launch:
    """The same body in a plane, on pads that are elastic themselves."""
    return planar.Launch(
        mass=20.0,
        inertia=0.8,
        arm=0.1,
        drop=0.1,
        length=0.016,
        width=2 * 0.016,
        stiffness=interface_stiffness,
        gravity=G,
        rail_end=0.132,
        start=0.022,
        speed=SPEED,
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


def both(scene, cells: int | None = None, size: float = 0.004) -> tuple:
    """The reference, and the surrogate ``on_both_walls``."""
    reference = highfi.run(scene, numerics=highfi.Numerics(element_size=size, cells=cells))
    return reference, *on_both_walls(scene, size)


def on_both_walls(scene, size: float) -> tuple:
    """The surrogate on rigid walls, and on those of the rail."""
    compliance = highfi.condense(scene, size)
    at_rest = dataclasses.replace(compliance, flexibility=np.zeros_like(compliance.flexibility))
    return lowfi.run(scene, compliance=at_rest), lowfi.run(scene, compliance=compliance)


@pytest.mark.case("O58")
@pytest.mark.parametrize("solver", ["surrogate", pytest.param("all", marks=pytest.mark.slow)])
def test_tip_off_at_full_weight(solver):
    """Pads tilt by 16 mrad as they leave. A planar body on springs: 0.75180 rad/s, and 5.000047 m/s,
    by the springs that push the last pad off. Control: about the
    middle of a pad that does not tilt, 0.7845 rad/s."""
    stiffness, scene = 1.8e10, tips_off(64.0, 1.8e10)
    state = planar.tip_off(on_springs(stiffness), TIP_OFF)
    assert state[[3, 5]] == pytest.approx([5.0000476, 0.751804], rel=2e-6)
    runs = both(scene, size=0.008) if solver == "all" else on_both_walls(scene, 0.008)
    for run in runs:
        assert run.status == "exited" and run.checks["energy_error"] < 1e-8
        assert run.outcome.rate[1] == pytest.approx(state[5], rel=3e-3)
        assert run.outcome.velocity[0] - SPEED == pytest.approx(state[3] - SPEED, rel=0.05)
        # 0.41 J of gravity's work
        assert 0.0 <= run.energy[-1, ledger.ENTRIES.index("released")] < 1e-4
    pivot = exact.tip_off(20.0, 0.8, 0.1, 0.2, SPEED, G)["rate"]
    assert abs(pivot / state[5] - 1.0) > 0.03


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
    """At full weight."""
    runs = [both(event(stiffer)) for stiffer in STIFFER]
    rigid = [apart(reference, on_rigid) for reference, on_rigid, _ in runs]
    real = [apart(reference, on_walls) for reference, _, on_walls in runs]
    slopes = np.diff(np.log(rigid), axis=0) / np.diff(np.log(STIFFER))[:, None]
    assert (slopes < -0.8).all() and (slopes > -1.2).all()
    # Control: with the rail's own flexibility little is left of the difference, so it was the
    # flexibility that made it.
    assert (np.array(real[0]) < 0.1 * np.array(rigid[0])).all()


@pytest.mark.slow
def test_the_limit_ends_at_the_cells_of_the_pads():
    """On a rail a thousand times stiffer what is left of the difference with the rail's own
    compliance is that of the cells, and falls with their number."""
    stiff = {cells: both(comes_against(0.0, 1024.0), cells) for cells in (4, 16)}
    floor = {
        cells: apart(reference, on_walls)[1] for cells, (reference, _, on_walls) in stiff.items()
    }
    assert floor[16] < 0.3 * floor[4]
