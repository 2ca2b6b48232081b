"""Small scenes for the surrogate's tests: one body, few pads, one effect. SI numbers.

Each set of effects that are present is one more kernel, which takes half a minute to compile. So
effects that a scene does not need are present without strength.
"""

import pytest

from tests import turning
from tipoff import lowfi, scenes
from tipoff.kernels import rotation
from tipoff.lowfi import state
from tipoff.lowfi.dynamics import integrate
from tipoff.lowfi.single_run import SingleRun

G = 9.80665
PAPER_PAD = {
    "law": "impact",
    "clearance": 1e-5,
    "exponent": 1.5,
    "stiffness": 70000.0 * 1000.0**1.5,
    "damping": 60000.0,
    "damping_depth": 3e-4,
}
RAIL = {
    "start": -100.0,
    "end": 100.0,
    "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
}
CENTRED = {"eccentricity": {"axial": 0.0}}
WEIGHTLESS = {"x": 0.0, "y": 0.0, "z": 0.0}
IMMOVABLE = {"mass": 1e15, "inertia": {"xx": 1e15, "yy": 1e15, "zz": 1e15}}
SMOOTH = {"static": 0.0, "dynamic": 0.0, "static_speed": 1e-3, "dynamic_speed": 2e-3}
ONE_PAD = [{"position": (0.0, 0.0, -0.1), "normals": ["-z"]}]


def corners(x: float = 0.1, y: float = 0.1, z: float = 0.1, normals=("y", "z")) -> list[dict]:
    """Pads at the eight corners of a box, with outward normals along the named axes."""
    signs = [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    mark = {-1: "-", 1: "+"}
    return [
        {
            "position": (a * x, b * y, c * z),
            "normals": [mark[b if n == "y" else c] + n for n in normals],
        }
        for a, b, c in signs
    ]


def with_neutral_effects(raw: dict) -> dict:
    """The tables of a scene with those of absent effects, without strength. With a Gaussian
    thrust they are those of the reference scene, which has a platform and no gravity, elsewhere
    those of one body."""
    neutral = {"thrust_offset": CENTRED}
    if raw["thrust"]["kind"] == "gaussian":
        neutral["platform"] = IMMOVABLE
    else:
        neutral["gravity"] = WEIGHTLESS
    if raw.get("contact"):
        neutral["friction"] = SMOOTH
    return neutral | raw


def scene(
    duration: float,
    interval: float,
    mass: float = 20.0,
    inertia: dict | None = None,
    pads: list | None = None,
    rail: dict | None = None,
    thrust: dict | None = None,
    **tables,
) -> scenes.Scene:
    """A scene whose fixed rails are so long that nothing leaves them, without thrust, offset of the
    thrust, gravity and friction unless ``thrust`` or ``tables`` give them."""
    none = {"kind": "constant", "force": 0.0, "duration": duration}
    raw = {
        "name": "test",
        "duration": duration,
        "payload": {"mass": mass, "inertia": inertia or {"xx": 0.3, "yy": 0.55, "zz": 0.6}},
        "pads": pads or ONE_PAD,
        "rail": rail or RAIL,
        "thrust": thrust or none,
        "output": {"interval": interval},
        **tables,
    }
    return scenes.parse(with_neutral_effects(raw), bare_numbers_are_si=True)


def numerics(tolerance: float) -> lowfi.Numerics:
    """The tolerance under test; the floor is low, so that it acts on slow bodies too."""
    return lowfi.Numerics(relative_tolerance=tolerance, speed_floor=1e-4)


def unwatched(asked: scenes.Scene, numerics: lowfi.Numerics, change=None) -> SingleRun:
    """A run over the scene's whole duration, from its state at ignition or that of ``change``: no
    exit and no jam ends it."""
    run = SingleRun(asked, numerics)
    if change is not None:
        run.loop = integrate.ready(run.system, change(state.initial(run.model)), run.plan.first)
    run.whole = True
    run.begin()
    run.integrate(None)
    return run


def turned_state(start, turn: tuple, bodies=state.BODIES):
    """State with some of its bodies turned about the scene's origin by the quaternion ``turn``."""
    new = start.copy()
    for body, moment in bodies:
        for first in (body + state.PLACE, body + state.VELOCITY, moment):
            vector = slice(first, first + 3)
            new[vector] = turning.turned(start[vector], turn)
        first = body + state.QUATERNION
        new[first : first + 4] = rotation.product(turn, tuple(start[first : first + 4]))
    return new


def drop(
    contact: dict,
    tolerance: float,
    duration: float,
    v: float = 0.05,
    mass: float = 20.0,
    pads: list | None = None,
    along: float = 1.0,
    **tables,
):
    """A body thrown at ``v`` (m/s) along -z onto its pads' wall; ``duration`` (s) is that of the
    contact, roughly.

    It also slides along the rail at ``along`` (m/s), so that a long contact is no jam. Returns what
    was measured and the trajectory.
    """
    gap = contact["clearance"]
    length = gap / v + 1.3 * duration
    run = lowfi.run(
        scene(
            length,
            length / 6000,
            mass=mass,
            pads=pads,
            contact=contact,
            initial={"velocity": {"x": along, "z": -v}},
            **tables,
        ),
        "springs",
        numerics=numerics(tolerance),
    )
    assert run.status == "time_limit", run.message
    height, speed = run.position[:, 2] + gap, run.velocity[:, 2]
    # Before and after the contact the body flies straight, so both ends of the contact are known
    # exactly.
    begin, end = gap / v, run.time[-1] - height[-1] / speed[-1]
    force = run.pad_force[:, :, 2].sum(axis=1)
    return {
        "restitution": speed[-1] / v,
        "penetration": -height.min(),
        "force": force.max(),
        "duration": end - begin,
    }, run


def close(found: dict, expected: dict, relative: float) -> None:
    """Every expected number is met within ``relative``."""
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=relative, abs=0.0), name
