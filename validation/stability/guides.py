"""Hard guides for the rigid surrogate: no clearance, wedging, a platform that turns. Stick-slip
belongs here.

A slider on a guide of length s without clearance, pushed by F at an offset r, has the net force F (1 - 2
mu r / s). It locks for 2 mu r / s >= 1 (moments about its middle).
"""

import math

import numpy as np

from tipoff.kernels import rotation
from tipoff.mechanics import outcome
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene, load, parse
from validation.stability import weaker_methods as weaker
from validation.stability.contacts import DEFAULT_STEP, run_on_springs
from validation.stability.verdict import (
    Control,
    Measure,
    Stability,
    Verdict,
    stability,
    verdict,
)

_RAIL = {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33}


def zero_clearance() -> Verdict:
    """The reference scene without clearance and with a centred thrust: eight pads touch without
    force."""
    scene = load("reference").replace(
        {"contact.clearance": 0.0, "friction": None, "thrust_offset": None, "platform": None}
    )
    found, record, mass = run_on_springs(scene, 1e-11), scene.thrust.record(), scene.payload.mass
    end = float(found.time[-1])
    exact = thrust_law.impulse(record, end) / mass
    stray = max(
        np.abs(found.velocity[:, 1:]).max(),
        np.abs(found.rate).max(),
        np.abs(found.pad_force[0]).max(),
    )

    def acceleration(t, _, __):
        return thrust_law.magnitude(record.pulses, record.curve, t) / mass

    _, control = weaker.semi_implicit_euler(
        acceleration, 0.0, 0.0, DEFAULT_STEP, round(end / DEFAULT_STEP)
    )
    exact_control = thrust_law.impulse(record, round(end / DEFAULT_STEP) * DEFAULT_STEP) / mass
    return verdict(
        "zero clearance, eight pads",
        "lowfi",
        Measure(
            "exit speed against impulse / mass; lateral speed (m/s), rate (rad/s), force at ignition "
            "(N)",
            float(max(abs(found.velocity[-1, 0] / exact - 1.0), stray)),
            1e-9,
        ),
        Control(
            "semi-implicit Euler, fixed step 0.1 ms: exit speed", abs(control / exact_control - 1.0)
        ),
        "no chatter: no pad force at any sample"
        if not found.pad_force.any()
        else "pads push each other",
        stable=stability(found),
    )


_STIFFNESS, _PUSH, _MASS, _SPAN = 7e7, 2000.0, 20.0, 0.2


def _slider(mu: float, offset: float, duration: float, transition: float) -> Scene:
    pads = [
        {"position": [x, 0.0, z], "normals": [normal]}
        for x in (-0.1, 0.1)
        for z, normal in ((-0.02, "-z"), (0.02, "+z"))
    ]
    return parse(
        {
            "name": "slider",
            "duration": duration,
            "pads": pads,
            "payload": {"mass": _MASS, "inertia": dict.fromkeys(("xx", "yy", "zz"), 0.8)},
            "rail": {"start": -10.0, "end": 10.0, "material": _RAIL},
            "output": {"interval": 1e-4},
            "contact": {
                "law": "linear",
                "clearance": 0.0,
                "stiffness": _STIFFNESS,
                "damping": 3.704e4,
            },
            "friction": {
                "static": mu,
                "dynamic": mu,
                "static_speed": transition,
                "dynamic_speed": 2.0 * transition,
            },
            "thrust": {"kind": "constant", "force": _PUSH, "duration": 1.0},
            "thrust_offset": {"eccentricity": {"axial": offset}},
        },
        bare_numbers_are_si=True,
    )


def _whole(scene: Scene) -> Trajectory:
    """The run to the end of the scene, also after a jam."""
    from tipoff.lowfi import Numerics
    from tipoff.lowfi.single_run import SingleRun

    made = SingleRun(scene, Numerics(relative_tolerance=1e-7))
    made.whole = True
    made.begin()
    made.integrate(None)
    return made.trajectory()


def _stopped(found: Trajectory, mu: float, offset: float, transition: float) -> Stability:
    """A slider's ``Stability``: near rest each of two pads damps it by N times 3 mu / 2 v_s, N = F
    r / s; critical at 2 m / c."""
    damping = 2.0 * _PUSH * offset / _SPAN * 1.5 * mu / transition
    return stability(found)._replace(critical_step_s=2.0 * _MASS / damping)


def wedged() -> Verdict:
    """mu 0.8 with the push at 130 mm, just beyond the lock: it jams, and there is no exit speed."""
    found, smooth = (_whole(_slider(0.8, 0.130, 0.2, transition)) for transition in (5e-4, 0.05))
    jammed = run_on_springs(_slider(0.8, 0.130, 0.2, 5e-4), 1e-7)
    return verdict(
        "wedged at 1.04 of the lock",
        "lowfi",
        Measure("travel in 0.2 s (mm)", 1e3 * float(found.position[-1, 0]), 0.5),
        Control("friction smoothed over 50 mm/s: travel", 1e3 * float(smooth.position[-1, 0])),
        f"status {jammed.status}",
        holds=jammed.status == "jammed" and jammed.outcome.velocity is None,
        stable=_stopped(found, 0.8, 0.130, 5e-4),
    )


def nearly_wedged() -> Verdict:
    """mu 0.8 with the push at 120 mm, just before the lock: 4 % of the push remains."""
    found, smooth = (_whole(_slider(0.8, 0.120, 0.04, transition)) for transition in (1e-3, 0.5))
    exact = (1.0 - 2.0 * 0.8 * 0.120 / _SPAN) * _PUSH / _MASS
    measured, control = (
        (one.velocity[400, 0] - one.velocity[200, 0]) / 0.02 for one in (found, smooth)
    )
    return verdict(
        "sliding at 0.96 of the lock",
        "lowfi",
        Measure(
            "relative error of the acceleration from 20 to 40 ms", abs(measured / exact - 1.0), 0.02
        ),
        Control("friction smoothed over 0.5 m/s: acceleration", abs(control / exact - 1.0)),
        f"status {found.status}",
        stable=_stopped(found, 0.8, 0.120, 1e-3),
    )


# rotation vector (rad) to other inertial axes, about no axis of the scene
_TURN = (0.7, -1.1, 0.4)


def _spinning() -> Scene:
    """A launcher that rotates at 0.5 rad/s while the payload moves slowly along 3 m of rail. A
    lateral thrust presses the payload into a corner."""
    rate, arm = np.array([0.5, 0.003, -0.002]), np.array([0.1, 1.2e-4, 1.2e-4])
    turning = dict(zip("xyz", rate.tolist()))
    carried = np.cross(rate, arm) + np.array([0.12, 0.0, 0.0])
    pads = [
        {
            "position": [0.08 * x, 0.1 * y, 0.1 * z],
            "normals": ["-+"[y > 0] + "y", "-+"[z > 0] + "z"],
        }
        for x in (-1, 1)
        for y in (-1, 1)
        for z in (-1, 1)
    ]
    return parse(
        {
            "name": "spinning",
            "duration": 39.0,
            "pads": pads,
            "payload": {"mass": 9.9, "inertia": {"xx": 0.066, "yy": 0.134, "zz": 0.128}},
            "rail": {"start": -0.1, "end": 3.2, "material": _RAIL},
            "output": {"interval": 0.02},
            "platform": {
                "mass": 81.2,
                "inertia": dict.fromkeys(("xx", "yy", "zz"), 4.9),
                "mass_centre": {"x": -0.1},
            },
            "contact": {
                "law": "impact",
                "clearance": 1e-4,
                "exponent": 1.0,
                "stiffness": 1e3,
                "damping": 60.0,
                "damping_depth": 1e-4,
            },
            "friction": {
                "static": 0.02,
                "dynamic": 0.02,
                "static_speed": 1e-3,
                "dynamic_speed": 2e-3,
            },
            "thrust": {"kind": "gaussian", "peak": 1.0, "width": 7.0, "centre": 15.0, "arm": 1e-6},
            "thrust_offset": {"misalignment": {"axial": math.pi / 2, "radial": math.pi / 4}},
            "initial": {
                "position": {"y": 1.2e-4, "z": 1.2e-4},
                "velocity": dict(zip("xyz", carried.tolist())),
                "rate": turning,
                "platform_rate": turning,
            },
        },
        bare_numbers_are_si=True,
    )


def _seen_from(scene: Scene, turn: tuple | None) -> Trajectory:
    """The run after a rotation of its bodies about the origin of the scene by a rotation vector."""
    from tipoff.lowfi import Numerics, state
    from tipoff.lowfi.dynamics import integrate
    from tipoff.lowfi.single_run import SingleRun

    made = SingleRun(scene, Numerics(relative_tolerance=7e-13))
    if turn:
        start, q = state.initial(made.model), rotation.exponential(turn)
        frame = rotation.matrices(np.array([q]))[0]
        for body, moment in state.BODIES:
            for first in (body + state.PLACE, body + state.VELOCITY, moment):
                start[first : first + 3] = frame @ start[first : first + 3]
            first = body + state.QUATERNION
            start[first : first + 4] = rotation.product(q, tuple(start[first : first + 4]))
        made.loop = integrate.ready(made.system, start, made.interval)
    made.begin()
    made.integrate(None)
    return made.trajectory()


def turning_platform() -> Verdict:
    """Three full turns during the ejection: the motion relative to the platform must not depend on
    the inertial axes."""
    scene = _spinning()
    found, other = _seen_from(scene, None), _seen_from(scene, _TURN)
    ours, theirs = outcome.relative_motion(found), outcome.relative_motion(other)
    across = slice(0, len(found.time) // 2), slice(1, 3)  # while on the rail
    fixed = np.einsum(
        "nji,nj->ni",
        rotation.matrices(found.platform_quaternion),
        found.velocity - found.platform_velocity,
    )
    size = np.abs(ours["relative_velocity"][across]).max()
    figure = max(
        np.abs(theirs["relative_velocity"] - ours["relative_velocity"]).max()
        / np.abs(ours["relative_velocity"]).max(),
        np.abs(other.rate - found.rate).max() / np.abs(found.rate).max(),
    )
    wrong = np.abs(fixed[across] - ours["relative_velocity"][across]).max() / size
    return verdict(
        "platform turns three times",
        "lowfi",
        Measure(
            "relative change of relative velocity and rate in other inertial axes",
            float(figure),
            1e-9,
        ),
        Control("relative velocity without the frame's turning", float(wrong)),
        f"status {found.status}",
        stable=stability(found),
    )


CASES = {case.__name__: case for case in (zero_clearance, wedged, nearly_wedged, turning_platform)}
