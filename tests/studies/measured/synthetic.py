"""Drop tests in closed form: constant rates before and after, a half-sine burn, any sensor; no
surrogate and no file."""

import numpy as np

from tests.studies.measured.sensor import Channel, Sensor, measured
from tipoff.studies.measured.events import GRAVITY, Spans
from tipoff.studies.measured.log import Calibrated, Log
from tipoff.studies.measured.sheet import Sheet

INTERVAL, RELEASE, IGNITION, BURN, EXIT, END = 1e-3, 1.15, 1.5, 0.03, 0.04, 1.75
NONE = np.zeros((3, 3))
QUIET = Sensor(
    Channel(np.zeros(3), np.zeros(3), 0.0, 0.0, 10.0),
    Channel(np.zeros(3), np.zeros(3), 0.0, 0.0, 1000.0),
    NONE,
    NONE,
    np.zeros(3),
    293.15,
    0.0,
    np.eye(3),
)


def sheet(**changed) -> Sheet:
    """A sheet without calibration; SI. ``gyro`` and ``windows`` are laid over the defaults, all
    else replaces them."""
    uncertain = {"bias_instability": 0.0, "scale": 0.0, "misalignment": 0.0, "g_sensitivity": 0.0}
    raw = {
        "file": "none.csv",
        "channel_class": 60,
        "axes": np.eye(3).tolist(),
        "accelerometer": {"range": 1000.0},
        "columns": {"time": "t", "rate": ["x", "y", "z"], "acceleration": ["a", "b", "c"]},
        "units": {"time": "s", "rate": "rad/s", "acceleration": "m/s**2"},
        "gyro": {"range": 10.0, "resolution": 0.0, "uncertainty": uncertain}
        | changed.pop("gyro", {}),
        "windows": {"exit": EXIT} | changed.pop("windows", {}),
    }
    return Sheet.model_validate(raw | changed, context={"bare_numbers_are_si": True})


def motion(before, after) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """time (n,), rate (n,3) that goes from ``before`` to ``after`` during the burn, specific force
    (n,3): g, nothing, thrust, nothing."""
    time = INTERVAL * np.arange(round(END / INTERVAL))
    burnt = np.clip((time - IGNITION) / BURN, 0.0, 1.0)
    rate = np.asarray(before) + (0.5 - 0.5 * np.cos(np.pi * burnt))[:, None] * (
        np.asarray(after) - np.asarray(before)
    )
    force = np.zeros((time.size, 3))
    force[time < RELEASE, 2] = GRAVITY
    force[:, 0] = 300.0 * np.sin(np.pi * burnt)
    return time, rate, force


def caught(time, rate, force, length: float = 0.5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The same, and then a net that brakes the platform for ``length`` (s) of a log that is as much
    longer. It pulls along +X too: less than thrust does, for so long that its impulse is larger,
    and it shakes the payload."""
    after = time[-1] + INTERVAL * np.arange(1, round(length / INTERVAL) + 1)
    pull = np.sin(np.pi * (after - time[-1]) / length)
    shaken = rate[-1] + 0.5 * np.sin(60.0 * (after - time[-1]))[:, None]
    return (
        np.concatenate([time, after]),
        np.vstack([rate, shaken]),
        np.vstack([force, pull[:, None] * np.array([40.0, 0.0, 60.0])]),
    )


def log(sensor: Sensor, before, after, rng, kelvin: float = 293.15) -> Log:
    """What a sensor makes of it."""
    time, rate, force = motion(before, after)
    raw, pushed = measured(sensor, rate, force, np.full(time.size, kelvin), INTERVAL, rng)
    nothing = np.zeros(time.size, dtype=bool)
    return Log(time, raw, pushed, np.full(time.size, kelvin), nothing, nothing, [])


def spans() -> Spans:
    """The windows of the motion."""
    return Spans(
        (RELEASE - 1.0, RELEASE - 0.02),
        (RELEASE + 0.05, IGNITION - 0.02),
        (IGNITION + 0.045, IGNITION + 0.145),
        IGNITION + 0.042,
    )


def samples(rate, force=None) -> Calibrated:
    """Calibrated samples at the instants of the motion."""
    return Calibrated(INTERVAL * np.arange(len(rate)), rate, force, None)
