"""The motion of a payload in a drop tower, from rest on the hoist to free flight, for simulated
logs.

The platform hangs, swings a little, is let go within milliseconds with a kick that rings out,
falls, and the thruster ignites: from there to the settled state the surrogate's trajectory, started
with the rates the platform falls with; then Euler's equations without a moment, I w' = -w x I w.
The specific force at the unit, at r from the mass centre, is v' - g + w' x r + w x (w x r). Air,
the cable and the payload's weight on its pads while hanging are left out.
"""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from tipoff import lowfi
from tipoff.kernels import rotation
from tipoff.scenes.body import tensor
from tipoff.scenes.scene import Scene
from tipoff.studies.measured.events import GRAVITY


class Tower(NamedTuple):
    """Lengths of the stages (s): ``hang``, ``fall`` until ignition, ``flight`` after it. ``swing``
    (rad/s) and its frequency (Hz) while hanging; ``rate`` (3,) rad/s in free fall; ``kick`` (rad/s)
    by the release, its frequency (Hz) and decay (s); time in which the release lets go (s);
    ``knock`` (m/s2) of the release, along X; ``up`` and the unit's ``place`` (m) in body axes."""

    hang: float = 1.25
    fall: float = 0.40
    flight: float = 0.20
    swing: float = np.radians(0.12)
    swing_frequency: float = 0.6
    rate: tuple = (np.radians(0.05), np.radians(-0.08), np.radians(0.06))
    kick: float = np.radians(0.4)
    kick_frequency: float = 45.0
    kick_decay: float = 0.008
    letting_go: float = 0.0015
    knock: float = 25.0
    up: tuple = (0.0, 0.0, 1.0)
    place: tuple = (0.03, 0.02, -0.01)


class Motion(NamedTuple):
    """time (n,) s from the first sample, rate (n,3) rad/s and specific force (n,3) m/s2 at the unit
    in body axes; release, ignition and exit (s); the true ``change`` (3,) rad/s: the surrogate's
    settled rate less the rate before ignition."""

    time: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    release: float
    ignition: float
    exit: float
    change: np.ndarray


def drop(scene: Scene, tower: Tower, interval: float) -> Motion:
    """A drop of ``scene`` sampled every ``interval`` (s). Raises ValueError where the payload does
    not settle."""
    began = {
        f"initial.{body}.{axis}": float(value)
        for body in ("rate", "platform_rate")
        for axis, value in zip("xyz", tower.rate)
    }
    run = lowfi.run(scene.replace(began), "springs")
    if run.outcome.rate is None or run.outcome.exit_time is None:
        raise ValueError(f"{scene.name}: {run.status} {run.message}: nothing to measure")
    ignition = tower.hang + tower.fall
    time = interval * np.arange(round((ignition + tower.flight) / interval))
    rate, force = _before(tower, time)
    fired = time >= ignition
    rate[fired], force[fired] = _after(scene, run, tower, time[fired] - ignition)
    return Motion(
        time,
        rate,
        force,
        tower.hang,
        ignition,
        run.outcome.exit_time,
        np.array(run.outcome.rate) - np.array(tower.rate),
    )


def _before(tower: Tower, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    since = np.clip(time - tower.hang, 0.0, None)
    swing = (
        tower.swing
        * np.sin(2.0 * np.pi * tower.swing_frequency * time)[:, None]
        * np.array([0.2, 1.0, 0.6])
    )
    ring = (
        tower.kick
        * np.exp(-since / tower.kick_decay)
        * np.sin(2.0 * np.pi * tower.kick_frequency * since)
    )
    falling = np.array(tower.rate) + ring[:, None] * np.array([0.3, 1.0, -0.7])
    held = np.clip(1.0 - (time - tower.hang) / tower.letting_go, 0.0, 1.0)[:, None]
    force = GRAVITY * held * np.array(tower.up)
    force[:, 0] += tower.knock * np.exp(-since / tower.letting_go) * (since > 0.0)
    return np.where((time < tower.hang)[:, None], swing, falling), force


def _after(scene: Scene, run, tower: Tower, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates and forces from the samples of the surrogate, then in free flight."""
    inertia = tensor(scene.payload.inertia)
    inverse = np.linalg.inv(inertia)

    def turning(_, rate):
        return -inverse @ np.cross(rate, inertia @ rate)

    last = run.time[-1]
    later = scipy.integrate.solve_ivp(
        turning, (last, time[-1] + 1e-9), run.rate[-1], rtol=1e-10, atol=1e-12, dense_output=True
    )
    turned = rotation.matrices(run.quaternion)
    pushed = np.einsum("nji,nj->ni", turned, np.gradient(run.velocity, run.time, axis=0))
    spun = np.gradient(run.rate, run.time, axis=0)
    flying = time > last
    rate = np.column_stack([np.interp(time, run.time, column) for column in run.rate.T])
    rate[flying] = later.sol(time[flying]).T
    force, turn = (
        np.column_stack([np.interp(time, run.time, column) for column in values.T])
        for values in (pushed, spun)
    )
    force[flying], turn[flying] = 0.0, [turning(0.0, value) for value in rate[flying]]
    place = np.array(tower.place)
    return rate, force + np.cross(turn, place) + np.cross(rate, np.cross(rate, place))
