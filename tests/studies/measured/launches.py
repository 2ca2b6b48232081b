"""Logs of launches from known runs: a unit with bias, noise, scale error, a turned mounting and latency at the mass
centre of a rocket that leaves its rail.

The unit gives the mean specific force over its interval, as one with an anti-alias filter does. After the end of a
run the rates go on along their slope.
"""

from typing import NamedTuple

import numpy as np

from tests.studies.measured.sensor import Channel, Sensor, measured
from tipoff.kernels import rotation
from tipoff.results.trajectory import Trajectory
from tipoff.studies.measured.log import Log
from tipoff.studies.measured.sheet import LaunchSheet

REST, AFTER = 0.8, 0.12  # s before the start and after the exit
NOISE, FORCE_NOISE = np.radians(0.3), 0.25  # of a sample at 1 kHz: rad/s, m/s2
SCALE, SKEW, DELAY = 0.005, np.radians(0.3), 0.3e-3
TRAVEL = 2e-3  # m


class Errors(NamedTuple):
    """What a unit does: ``bias`` (3,) rad/s and of the force (3,) m/s2, relative ``scale`` error of both,
    ``turn`` (3,) rad of its mounting, ``latency`` of the log and ``delay`` of the rates behind it (s), ``phase``
    of the samples (0 to 1)."""

    bias: np.ndarray
    force_bias: np.ndarray
    scale: tuple[float, float]
    turn: np.ndarray
    latency: float
    delay: float
    phase: float


def drawn(generator: np.random.Generator) -> Errors:
    """Errors of a unit as far as its sheet knows them; the bias is not known at all."""
    return Errors(
        np.radians(generator.uniform(-2.0, 2.0, 3)),
        generator.uniform(-0.2, 0.2, 3),
        tuple(SCALE * generator.standard_normal(2)),
        SKEW * generator.standard_normal(3),
        generator.uniform(0.0, 0.02),
        DELAY * generator.standard_normal(),
        generator.random(),
    )


def sheet(**launch) -> LaunchSheet:
    """The sheet of the unit."""
    sure = {"bias_instability": 0.0, "scale": SCALE, "misalignment": SKEW, "g_sensitivity": 0.0}
    raw = {
        "file": "none.csv",
        "axes": np.eye(3).tolist(),
        "columns": {"time": "t", "rate": ["x", "y", "z"], "acceleration": ["a", "b", "c"]},
        "units": {"time": "s", "rate": "rad/s", "acceleration": "m/s**2"},
        "gyro": {"range": 35.0, "resolution": 0.0, "uncertainty": sure},
        "accelerometer": {"range": 1e5, "scale_uncertainty": SCALE},
        "launch": {
            "travel_uncertainty": TRAVEL,
            "delay_uncertainty": DELAY,
            "after": 0.06,
            "at_rest": 0.5,
        }
        | launch,
    }
    return LaunchSheet.model_validate(raw, context={"bare_numbers_are_si": True})


def log(
    run: Trajectory,
    gravity: np.ndarray,
    errors: Errors,
    seed: int,
    rough: float = 0.0,
    interval: float = 1e-3,
) -> Log:
    """The log of a ``run`` under ``gravity`` (3,) m/s2 by a unit with ``errors``. A ``rough`` rail shakes it across
    the axis up to the exit, by so many times its noise. ``interval`` between samples (s)."""
    assert run.outcome.exit_time is not None
    until = run.outcome.exit_time + AFTER
    time = interval * (np.arange(-round(REST / interval), round(until / interval)) + errors.phase)
    rate, force = motion(run, gravity, time, errors.delay)
    generator = np.random.default_rng(seed)
    sliding = rough * ((time > 0.0) & (time < run.outcome.exit_time))[:, None]
    force[:, 1:] += sliding * FORCE_NOISE * generator.standard_normal((time.size, 2))
    rate = rate + sliding * NOISE * generator.standard_normal((time.size, 3))
    left, _, right = np.linalg.svd(np.eye(3) + np.cross(np.eye(3), errors.turn))
    unit = Sensor(
        Channel(errors.bias, np.full(3, errors.scale[0]), NOISE * np.sqrt(1e-3), 0.0, 35.0),
        Channel(
            errors.force_bias, np.full(3, errors.scale[1]), FORCE_NOISE * np.sqrt(1e-3), 0.0, 1e5
        ),
        np.zeros((3, 3)),
        np.zeros((3, 3)),
        np.zeros(3),
        293.15,
        0.0,
        left @ right,
    )
    warm = np.full(time.size, 293.15)
    raw, pushed = measured(unit, rate, force, warm, interval, generator)
    nothing = np.zeros(time.size, dtype=bool)
    return Log(time + REST + errors.latency, raw, pushed, None, nothing, nothing, [])


def table(log: Log) -> np.ndarray:
    """Time, rates in deg/s and forces of a log, (n,7)."""
    assert log.acceleration is not None
    return np.column_stack([log.time, np.degrees(log.rate), log.acceleration])


def text(rows: np.ndarray) -> str:
    """The CSV file of such a table."""
    lines = [",".join(f"{value:.4f}" for value in row) for row in rows.tolist()]
    return "\n".join(["time,gx,gy,gz,ax,ay,az", *lines]) + "\n"


def motion(
    run: Trajectory, gravity: np.ndarray, time: np.ndarray, delay: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """True rates (n,3) rad/s, ``delay`` (s) late, and mean specific forces (n,3) m/s2 over the intervals around
    the instants ``time`` (n,)."""
    # the thrust of the scene ends where the settled window begins; the motor of the log burns on
    burnt = run.outcome.window_start - 2e-3
    known, step = run.time[run.time < burnt], time[1] - time[0]

    def at(values, instants):
        kept = values[: known.size]
        slope = (kept[-1] - kept[-11]) / (known[-1] - known[-11])
        found = np.column_stack([np.interp(instants, known, column) for column in kept.T])
        return found + np.clip(instants - known[-1], 0.0, None)[:, None] * slope

    seen = time - delay
    rate = np.where((seen < 0.0)[:, None], 0.0, at(run.rate, seen))
    speeds = [at(run.velocity, time + side * step) for side in (-0.5, 0.5)]
    lost = (speeds[1] - speeds[0]) / step - gravity
    turned = rotation.matrices(run.quaternion)
    places = np.clip(np.searchsorted(run.time, time), 0, run.time.size - 1)
    return rate, np.einsum("nji,nj->ni", turned[places], lost)
