"""Hard cases of the rigid surrogate, with closed forms.

Impact of m at speed v on a wall F = k p^n (energy, then one quadrature)::

    p = ((n + 1) m v^2 / (2 k))^(1/(n + 1)),   F = k p^n,
    T = (2 p / v) sqrt(pi) Gamma(1 + 1/(n + 1)) / Gamma(1/2 + 1/(n + 1))

Source: Goldsmith, Impact (1960), sections 4.2 and 4.4. Elastic impact on a free body: momentum and energy.
"""

import math

import numpy as np

from scenes.effects import thrust_law
from scenes.scene import Scene, load, parse
from scenes.trajectory import Trajectory
from studies import weaker_methods as weaker
from studies.hard_cases import Verdict, verdict

_DEFAULT_STEP = 1e-4  # s: what a careless user of a fixed-step code would take


def single_pad(mass: float, contact: dict | None, **tables) -> Scene:
    """A payload with one pad above its mass centre, so that contact turns nothing; SI numbers."""
    inertia = 0.4 * mass * 0.05**2
    return parse({
        "name": "single pad", "duration": 1e-3, "payload": {"mass": mass, "inertia": dict.fromkeys(("xx", "yy", "zz"), inertia)},
        "pads": [{"position": [0.0, 0.05, 0.0], "normals": ["+y"]}],
        "rail": {"start": -0.5, "end": 0.5, "material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33}},
        "thrust": {"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 1e-3, "reaction": "exhaust"},
        **({"contact": contact} if contact else {}), **tables}, bare_numbers_are_si=True)


def _run(scene: Scene, relative_tolerance: float = 1e-9) -> Trajectory:
    import lowfi

    return lowfi.run(scene, numerics=lowfi.Numerics(relative_tolerance=relative_tolerance))


def stiff_pad() -> Verdict:
    """The paper's pad a thousand times stiffer: 20 kg at 50 mm/s stay 0.22 ms in contact."""
    mass, speed, stiffness, exponent, gap = 20.0, 0.05, 7e7 * 1000.0**1.5, 1.5, 1e-6
    depth = ((exponent + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** (1.0 / (exponent + 1.0))
    duration = (2.0 * depth / speed) * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9)
    exact = np.array([depth, stiffness * depth**exponent, duration, -speed])
    contact = {"law": "impact", "clearance": gap, "exponent": exponent, "stiffness": stiffness, "damping": 0.0,
               "damping_depth": 3e-4}
    scene = single_pad(mass, contact, duration=3e-4, initial={"velocity": {"y": speed}}, output={"interval": 2e-8})
    run = _run(scene)
    force = np.abs(run.pad_force[:, :, 1]).sum(axis=1)
    touching = np.flatnonzero(force > 0.0)
    found = [run.position[:, 1].max() - gap, force.max(), run.time[touching[-1]] - run.time[touching[0]], run.velocity[-1, 1]]

    def acceleration(_, x, __):
        return -stiffness * max(x, 0.0) ** exponent / mass

    _, control = weaker.runge_kutta(acceleration, -gap, speed, _DEFAULT_STEP, 10)
    return verdict("stiff pad, k x 1000", "lowfi", "largest relative error of penetration, force, duration, rebound speed",
                   float(np.abs(found / exact - 1.0).max()), 1e-3, "Runge-Kutta 4, fixed step 0.1 ms: rebound speed",
                   abs(control / -speed - 1.0), f"contact lasts {1e3 * duration:.3g} ms")


def zero_clearance() -> Verdict:
    """The reference with closed gaps and a centred thrust: eight pads touch, none may push."""
    scene = load("reference").replace({"contact.clearance": 0.0, "friction": None, "thrust_offset": None, "platform": None})
    run, record, mass = _run(scene, 1e-11), scene.thrust.record(), scene.payload.mass
    end = float(run.time[-1])
    exact = thrust_law.impulse(record, end) / mass
    stray = max(np.abs(run.velocity[:, 1:]).max(), np.abs(run.rate).max(), np.abs(run.pad_force[0]).max())

    def acceleration(t, _, __):
        return thrust_law.magnitude(record.pulses, record.curve, t) / mass

    _, control = weaker.semi_implicit_euler(acceleration, 0.0, 0.0, _DEFAULT_STEP, round(end / _DEFAULT_STEP))
    exact_control = thrust_law.impulse(record, round(end / _DEFAULT_STEP) * _DEFAULT_STEP) / mass
    return verdict("zero clearance, eight pads", "lowfi",
                   "exit speed against impulse / mass; lateral speed (m/s), rate (rad/s), force at ignition (N)",
                   float(max(abs(run.velocity[-1, 0] / exact - 1.0), stray)), 1e-9,
                   "semi-implicit Euler, fixed step 0.1 ms: exit speed", abs(control / exact_control - 1.0),
                   "no chatter: no pad force at any sample" if not run.pad_force.any() else "pads push each other")


def light_payload() -> Verdict:
    """1 g against a free platform of 150 kg on a linear pad: contact lasts 12 us, an eighth of the default step."""
    mass, heavy, stiffness, speed, gap = 1e-3, 150.0, 7e7, 1.0, 1e-6
    contact = {"law": "linear", "clearance": gap, "exponent": 1.0, "stiffness": stiffness, "damping": 0.0}
    platform = {"mass": heavy, "inertia": dict.fromkeys(("xx", "yy", "zz"), 10.0)}
    scene = single_pad(mass, contact, platform=platform, duration=5e-5, initial={"velocity": {"y": speed}},
                       output={"interval": 1e-6})
    run = _run(scene, 1e-10)
    exact = np.array([(mass - heavy) / (mass + heavy), 2.0 * mass / (mass + heavy)]) * speed
    found = np.array([run.velocity[-1, 1], run.platform_velocity[-1, 1]])
    momentum = abs(mass * found[0] + heavy * found[1] - mass * speed) / (mass * speed)
    reduced = mass * heavy / (mass + heavy)

    def acceleration(_, x, __):
        return -stiffness * max(x, 0.0) / reduced

    _, closing = weaker.runge_kutta(acceleration, -gap, speed, _DEFAULT_STEP, 10)
    return verdict("light payload, 1 g on 150 kg", "lowfi", "relative error of both speeds and of the momentum",
                   float(max(np.abs(found / exact - 1.0).max(), momentum)), 1e-6,
                   "Runge-Kutta 4, fixed step 0.1 ms: separation speed", abs(closing / -speed - 1.0),
                   f"contact lasts {1e6 * math.pi * math.sqrt(reduced / stiffness):.3g} us")


def short_pulse() -> Verdict:
    """100 N s in a pulse of 10 us: an integrator that looks only at the state steps over it."""
    mass, pulse = 20.0, {"kind": "gaussian", "impulse": 100.0, "width": 1e-5, "centre": 2.5e-4, "reaction": "exhaust"}
    scene = single_pad(mass, None, duration=2e-3, thrust=pulse, output={"interval": 1e-4})
    run, record = _run(scene), scene.thrust.record()

    def acceleration(t, _, __):
        return thrust_law.magnitude(record.pulses, record.curve, t) / mass

    _, control = weaker.runge_kutta(acceleration, 0.0, 0.0, _DEFAULT_STEP, 20)
    return verdict("short pulse, sigma 10 us", "lowfi", "relative error of the exit speed", abs(run.velocity[-1, 0] / 5.0 - 1.0),
                   1e-5, "Runge-Kutta 4, fixed step 0.1 ms: exit speed", abs(control / 5.0 - 1.0))


CASES = {"stiff_pad": stiff_pad, "zero_clearance": zero_clearance, "light_payload": light_payload, "short_pulse": short_pulse}
