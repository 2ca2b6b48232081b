"""Hard thrusts for the rigid surrogate: a pulse shorter than a step, and corners between steps. v = J / m
(momentum)."""

from tipoff.mechanics.laws import thrust as thrust_law
from validation.stability import weaker_methods as weaker
from validation.stability.contacts import DEFAULT_STEP, run_on_springs, single_pad
from validation.stability.verdict import Control, Measure, Verdict, stability, verdict

_MASS = 20.0


def _pushed(
    name: str, thrust: dict, duration: float, exact: float, limit: float, step: float
) -> Verdict:
    """Speed (m/s) after a thrust, and that of Runge-Kutta with a fixed ``step`` (s)."""
    scene = single_pad(
        _MASS,
        None,
        duration=duration,
        thrust=thrust | {"reaction": "exhaust"},
        output={"interval": step},
    )
    found, record = run_on_springs(scene), scene.thrust.record()

    def acceleration(t, _, __):
        return thrust_law.magnitude(record.pulses, record.curve, t) / _MASS

    _, control = weaker.runge_kutta(acceleration, 0.0, 0.0, step, round(duration / step))
    return verdict(
        name,
        "lowfi",
        Measure(
            "relative error of the exit speed", abs(found.velocity[-1, 0] / exact - 1.0), limit
        ),
        Control(
            f"Runge-Kutta 4, fixed step {1e3 * step:g} ms: exit speed", abs(control / exact - 1.0)
        ),
        stable=stability(found),
    )


def short_pulse() -> Verdict:
    """100 N s in a pulse of 10 us: an integrator whose step depends on the state alone misses it."""
    pulse = {"kind": "gaussian", "impulse": 100.0, "width": 1e-5, "centre": 2.5e-4}
    return _pushed("short pulse, sigma 10 us", pulse, 2e-3, 5.0, 1e-5, DEFAULT_STEP)


def rectangular_thrust() -> Verdict:
    """12.5 kN for 8.3 ms: on and off between the steps of a millisecond."""
    push = {"kind": "constant", "force": 12500.0, "start": 1.23e-3, "duration": 8.3e-3}
    return _pushed("rectangular thrust, 8.3 ms", push, 0.02, 5.1875, 1e-6, 1e-3)


CASES = {case.__name__: case for case in (short_pulse, rectangular_thrust)}
