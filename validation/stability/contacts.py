"""Hard contacts of the rigid surrogate, with closed forms.

Impact of m at speed v on a wall F = k p^n (energy, then one quadrature)::

    p = ((n + 1) m v^2 / (2 k))^(1/(n + 1)),   F = k p^n,
    T = (2 p / v) sqrt(pi) Gamma(1 + 1/(n + 1)) / Gamma(1/2 + 1/(n + 1)),   stored energy k p^(n + 1) / (n + 1)

Source: Goldsmith, Impact (1960), sections 4.2 and 4.4. Elastic impact on a free body: momentum and
energy.
"""

import math

import numpy as np

from tipoff.mechanics import ledger
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene, parse
from validation.stability import weaker_methods as weaker
from validation.stability.verdict import Control, Measure, Verdict, stability, verdict

DEFAULT_STEP = 1e-4  # s: a typical fixed step chosen without a step limit
_MASS, _LINEAR = 20.0, 7e7
_CARELESS = "explicit Euler, fixed step 0.1 ms"


def single_pad(
    mass: float, contact: dict | None, pads: list | None = None, end: float = 0.5, **tables
) -> Scene:
    """A payload with one pad above its mass centre, so that contact causes no rotation, or with
    ``pads``; rails end at ``end`` (m). SI."""
    inertia = 0.4 * mass * 0.05**2
    return parse(
        {
            "name": "single-pad",
            "duration": 1e-3,
            "payload": {"mass": mass, "inertia": dict.fromkeys(("xx", "yy", "zz"), inertia)},
            "pads": pads or [{"position": [0.0, 0.05, 0.0], "normals": ["+y"]}],
            "rail": {
                "start": -0.5,
                "end": end,
                "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33},
            },
            "thrust": {
                "kind": "gaussian",
                "peak": 0.0,
                "width": 1e-3,
                "centre": 1e-3,
                "reaction": "exhaust",
            },
            **({"contact": contact} if contact else {}),
            **tables,
        },
        bare_numbers_are_si=True,
    )


def power_pad(stiffness: float, exponent: float, clearance: float) -> dict:
    """``[contact]`` of an undamped pad k p^n; one law for all cases, so that one kernel runs
    them."""
    return {
        "law": "impact",
        "clearance": clearance,
        "exponent": exponent,
        "stiffness": stiffness,
        "damping": 0.0,
        "damping_depth": 3e-4,
    }


def run_on_springs(scene: Scene, relative_tolerance: float = 1e-9) -> Trajectory:
    """The run of the surrogate."""
    from tipoff import lowfi

    return lowfi.run(
        scene, "springs", numerics=lowfi.Numerics(relative_tolerance=relative_tolerance)
    )


def _thrown(
    stiffness: float,
    exponent: float,
    start: float,
    speed: float,
    duration: float,
    mass: float = _MASS,
) -> float:
    """Control: speed (m/s) by explicit Euler after ``duration`` (s), from a penetration (m) and a
    speed (m/s)."""
    return weaker.explicit_euler(
        lambda _, x, __: -stiffness * max(x, 0.0) ** exponent / mass,
        start,
        speed,
        DEFAULT_STEP,
        math.ceil(duration / DEFAULT_STEP),
    )[1]


def _impact(name: str, stiffness: float, exponent: float, limit: float) -> Verdict:
    """20 kg at 50 mm/s on k p^n."""
    speed, gap, share = 0.05, 1e-6, 1.0 / (exponent + 1.0)
    depth = ((exponent + 1.0) * _MASS * speed**2 / (2.0 * stiffness)) ** share
    duration = (
        (2.0 * depth / speed)
        * math.sqrt(math.pi)
        * math.gamma(1.0 + share)
        / math.gamma(0.5 + share)
    )
    exact = np.array([depth, stiffness * depth**exponent, duration, -speed])
    found = run_on_springs(
        single_pad(
            _MASS,
            power_pad(stiffness, exponent, gap),
            duration=1.3 * duration + gap / speed,
            initial={"velocity": {"x": 0.1, "y": speed}},
            output={"interval": duration / 1e4},
        )
    )
    force = np.abs(found.pad_force[:, :, 1]).sum(axis=1)
    touching = np.flatnonzero(force > 0.0)
    measured = [
        found.position[:, 1].max() - gap,
        force.max(),
        found.time[touching[-1]] - found.time[touching[0]],
        found.velocity[-1, 1],
    ]
    # At the largest depth the stiffness of the pad is exponent x force / depth.
    return verdict(
        name,
        "lowfi",
        Measure(
            "largest relative error of penetration, force, duration, rebound speed",
            float(np.abs(measured / exact - 1.0).max()),
            limit,
        ),
        Control(
            f"{_CARELESS}: rebound speed",
            abs(_thrown(stiffness, exponent, 0.0, speed, 1.3 * duration) / -speed - 1.0),
        ),
        f"contact lasts {1e3 * duration:.3g} ms",
        stable=stability(found, exponent * exact[1] / depth, _MASS),
    )


def stiff_pad() -> Verdict:
    """The paper's pad a thousand times stiffer: 20 kg at 50 mm/s stay 0.22 ms in contact."""
    return _impact("stiff pad, k x 1000", 7e7 * 1000.0**1.5, 1.5, 1e-3)


def steep_pad() -> Verdict:
    """k p^0.5: infinite stiffness at first touch, where a step limit from the stiffness would be
    zero."""
    return _impact("pad with exponent 0.5", 7e5, 0.5, 1e-2)


def flat_pad() -> Verdict:
    """k p^3: zero stiffness at first touch, where a step limit from the stiffness would be
    infinite."""
    return _impact("pad with exponent 3", 7e4 * 1000.0**3, 3.0, 1e-2)


def interference() -> Verdict:
    """A pad with a penetration of 20 um at the start: its elastic energy becomes kinetic."""
    depth, exponent = 20e-6, 1.0
    stored = _LINEAR * depth**2 / 2.0
    leaves = math.sqrt(2.0 * stored / _MASS)
    found = run_on_springs(
        single_pad(
            _MASS,
            power_pad(_LINEAR, exponent, 0.0),
            duration=5e-3,
            initial={"position": {"y": depth}, "velocity": {"x": 0.1}},
        )
    )
    entry = found.energy[0, ledger.ENTRIES.index("contact_stored")]
    return verdict(
        "pressed in by 20 um at the start",
        "lowfi",
        Measure(
            "relative error of stored energy and of the speed it becomes",
            float(max(abs(entry / stored - 1.0), abs(found.velocity[-1, 1] / -leaves - 1.0))),
            1e-3,
        ),
        Control(
            f"{_CARELESS}: speed", abs(_thrown(_LINEAR, exponent, depth, 0.0, 5e-3) / -leaves - 1.0)
        ),
        found.message,
        holds="pads 0" in found.message,
        stable=stability(found, _LINEAR, _MASS),
    )


def grazing() -> Verdict:
    """A wall another thousand times stiffer, passed at 5 m/s: the contact lasts 2 us, 1/50 of the
    default step."""
    stiffness, speed, gap = 7e13, 0.05, 1e-4
    found = run_on_springs(
        single_pad(
            _MASS,
            power_pad(stiffness, 1.0, gap),
            duration=6e-3,
            end=100.0,
            initial={"velocity": {"x": 5.0, "y": speed}},
        )
    )
    return verdict(
        "grazing, contact of 2 us",
        "lowfi",
        Measure(
            "relative error of the rebound speed", abs(found.velocity[-1, 1] / -speed - 1.0), 1e-4
        ),
        Control(
            f"{_CARELESS}: rebound speed",
            abs(_thrown(stiffness, 1.0, 0.0, speed, 1e-3) / -speed - 1.0),
        ),
        f"{found.cost['events']} events",
        stable=stability(found, stiffness, _MASS),
    )


def eight_pads() -> Verdict:
    """A flat drop on eight equal pads, in two orders: one bounce of eight springs, no spin, no
    difference."""
    places = [(x, 0.1, z) for x in (-0.2, -0.1, 0.1, 0.2) for z in (-0.1, 0.1)]
    pads = [{"position": list(place), "normals": ["+y"]} for place in places]
    speed, duration = 0.05, math.pi * math.sqrt(_MASS / (8.0 * _LINEAR))
    box = {"mass": _MASS, "inertia": {"xx": 0.3, "yy": 0.55, "zz": 0.6}}
    runs = [
        run_on_springs(
            single_pad(
                _MASS,
                power_pad(_LINEAR, 1.0, 1e-6),
                order,
                payload=box,
                duration=1e-3,
                output={"interval": 1e-6},
                initial={"velocity": {"x": 0.1, "y": speed}},
            )
        )
        for order in (pads, pads[::-1])
    ]
    found = runs[0]
    force, exact = (
        np.abs(found.pad_force[:, :, 1]).max(axis=0),
        speed * math.sqrt(_LINEAR * _MASS / 8.0),
    )
    order = np.abs(runs[1].velocity - found.velocity).max() / speed
    spin = max(np.abs(one.rate).max() for one in runs)
    return verdict(
        "flat drop on eight pads",
        "lowfi",
        Measure(
            "relative error of the eight forces and the rebound speed",
            float(
                max(np.abs(force / exact - 1.0).max(), abs(found.velocity[-1, 1] / -speed - 1.0))
            ),
            1e-4,
        ),
        Control(
            f"{_CARELESS}: rebound speed",
            abs(_thrown(8.0 * _LINEAR, 1.0, 0.0, speed, 1.3 * duration) / -speed - 1.0),
        ),
        f"spin {spin:.1g} rad/s, other order of pads {order:.1g}",
        holds=spin <= 1e-12 and order <= 1e-12,
        stable=stability(found, 8.0 * _LINEAR, _MASS),
    )


def rail_end() -> Verdict:
    """A pad pressed with 500 N passes the end of the rail: its energy is accounted for, no force
    follows."""
    depth = 500.0 / _LINEAR
    found = run_on_springs(
        single_pad(
            _MASS,
            power_pad(_LINEAR, 1.0, 0.0),
            end=1e-9,
            duration=5e-3,
            initial={"position": {"y": depth}, "velocity": {"x": 5.0}},
        )
    )
    stored, released = _LINEAR * depth**2 / 2.0, found.energy[-1, ledger.ENTRIES.index("released")]
    motion = _MASS * found.velocity[-1, 1] ** 2 / 2.0
    return verdict(
        "pad leaves the rail pressed",
        "lowfi",
        Measure(
            "share of the stored energy neither released nor in motion",
            abs((released + motion) / stored - 1.0),
            1e-3,
        ),
        Control("the same ledger without released energy", abs(motion / stored - 1.0)),
        "no force after the edge" if not found.pad_force[1:].any() else "a force after the edge",
        holds=not found.pad_force[1:].any(),
        stable=stability(found, _LINEAR, _MASS),
    )


def light_payload() -> Verdict:
    """1 g against a free platform of 150 kg on a linear pad: contact lasts 12 us, an eighth of the
    default step."""
    mass, heavy, speed = 1e-3, 150.0, 1.0
    platform = {"mass": heavy, "inertia": dict.fromkeys(("xx", "yy", "zz"), 10.0)}
    found = run_on_springs(
        single_pad(
            mass,
            power_pad(_LINEAR, 1.0, 1e-6),
            platform=platform,
            duration=5e-5,
            output={"interval": 1e-6},
            initial={"velocity": {"y": speed}},
        ),
        1e-10,
    )
    exact = np.array([(mass - heavy) / (mass + heavy), 2.0 * mass / (mass + heavy)]) * speed
    speeds = np.array([found.velocity[-1, 1], found.platform_velocity[-1, 1]])
    momentum = abs(mass * speeds[0] + heavy * speeds[1] - mass * speed) / (mass * speed)
    reduced = mass * heavy / (mass + heavy)
    return verdict(
        "light payload, 1 g on 150 kg",
        "lowfi",
        Measure(
            "relative error of both speeds and of the momentum",
            float(max(np.abs(speeds / exact - 1.0).max(), momentum)),
            1e-6,
        ),
        Control(
            f"{_CARELESS}: separation speed",
            abs(_thrown(_LINEAR, 1.0, 0.0, speed, 1e-3, reduced) / -speed - 1.0),
        ),
        f"contact lasts {1e6 * math.pi * math.sqrt(reduced / _LINEAR):.3g} us",
        stable=stability(found, _LINEAR, reduced),
    )


CASES = {
    case.__name__: case
    for case in (
        stiff_pad,
        steep_pad,
        flat_pad,
        interference,
        grazing,
        eight_pads,
        rail_end,
        light_payload,
    )
}
