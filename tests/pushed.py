"""Springs that push a free payload, for both models, and a plain integration of its motion."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.exact.spring import end_of_stroke
from tests.highfi.support import CENTRED, IMMOVABLE, tiny
from tipoff.kernels import rotation
from tipoff.results.trajectory import Trajectory

SPRING = {"kind": "spring", "preload": 2e4, "rate": 2e5, "stroke": 0.02}
# Preload (N), rate (N/m), stroke (m), y and z (m) of springs at three corners and beside the middle.
UNEQUAL = (
    (6000.0, 1e5, 0.020, 0.03, 0.04),
    (5200.0, 8e4, 0.022, -0.04, 0.03),
    (5500.0, 9e4, 0.018, -0.03, -0.04),
    (5100.0, 1.1e5, 0.021, 0.045, -0.02),
)
ARM = 0.1  # m
MASSES = (0.3, 0.5, 0.2, 0.4)  # kg, of the pushers of these springs
# Misalignment (rad) of these springs, and its clock angle (rad).
TILTS = ((0.02, 0.3), (0.03, 2.0), (0.0, 0.0), (0.025, 4.0))
ENOUGH = 1e-4  # s, after the last stroke
PUSHER = 0.5  # kg


def pushed(thrust: dict, duration: float, platform: dict = IMMOVABLE, **more):
    """A payload without contact that springs push from a platform; by default it does not move.
    ``more``: further values of the scene."""
    return tiny(
        duration=duration,
        output={"interval": duration / 5},
        contact=None,
        friction=None,
        platform=platform,
        thrust_offset=CENTRED,
        thrust=thrust,
        **more,
    )


def springs(numbers: Sequence[tuple] = UNEQUAL) -> dict:
    """The table ``[thrust]`` of these springs."""
    names = ("preload", "rate", "stroke", "y", "z")
    return {"kind": "springs", "arm": ARM, "springs": [dict(zip(names, row)) for row in numbers]}


def heavy_and_tilted() -> dict:
    """The table of the unequal springs with ``MASSES`` and ``TILTS``."""
    table = springs()
    for spring, mass, (axial, radial) in zip(table["springs"], MASSES, TILTS):
        spring |= {"mass": mass, "misalignment": {"axial": axial, "radial": radial}}
    return table


def check_share_of_a_pusher(run: Trajectory, payload: float, platform: float) -> None:
    """The last sample of ``run`` of ``SPRING`` with a pusher of ``PUSHER``, between bodies of these
    masses (kg): its kinetic energy is lost to both, the ledger closes and momentum is kept. Control:
    without the pusher's mass the payload is 2 % faster."""
    numbers = SPRING["preload"], SPRING["rate"], SPRING["stroke"], (payload, platform)
    exact, light = end_of_stroke(*numbers, pusher=PUSHER), end_of_stroke(*numbers)
    energy = SPRING["preload"] * SPRING["stroke"] - 0.5 * SPRING["rate"] * SPRING["stroke"] ** 2
    assert run.energy[-1, 0] == pytest.approx(energy - exact.kept, rel=1e-6)
    assert exact.kept > 0.04 * energy
    assert run.checks["energy_error"] < 1e-7
    assert run.checks["linear_momentum_error"] < 1e-12
    # Control:
    assert light.payload / exact.payload - 1.0 > 0.02


class Free(NamedTuple):
    """A payload at one instant."""

    time: float  # s
    velocity: np.ndarray  # (3,) m/s
    rate: np.ndarray  # (3,) rad/s, in body axes


def flown(
    mass: float,
    inertia: np.ndarray,
    numbers: Sequence[tuple] = UNEQUAL,
    masses: Sequence[float] = (0.0,) * 4,
    tilts: Sequence[tuple] = ((0.0, 0.0),) * 4,
) -> Free:
    """A payload of ``inertia`` (3,3) kg m2 on a fixed platform after all springs, by the plain
    equations of a rigid body: each spring pushes along its line at its point of the payload, up to its
    stroke of that point, and its pusher adds its mass to the mass matrix of the payload in this
    direction. From one end of a stroke to the next by Dormand and Prince of order eight, to 1e-12."""
    size, angle = np.array(tilts).T
    lines = np.column_stack(
        [np.cos(size), np.sin(size) * np.cos(angle), np.sin(size) * np.sin(angle)]
    )
    points = np.array([(-ARM, y, z) for *_, y, z in numbers])
    preload, rate, stroke = np.array([row[:3] for row in numbers]).T
    acts = np.ones(len(numbers), dtype=bool)

    def travel(state):
        turn = rotation.matrices(state[None, 6:10])[0]
        return ((state[:3] + points @ turn.T - points) * lines).sum(axis=1)

    def change(_, state):
        turn = rotation.matrices(state[None, 6:10])[0]
        spin = np.linalg.solve(inertia, state[10:13])
        force = np.where(acts, preload - rate * travel(state), 0.0)
        turning = rotation.product(tuple(state[6:10]), (0.0, *(0.5 * spin)))
        # rows of the speed of each travel over velocity and body rate, and its acceleration at constant ones
        rows = np.hstack([lines, np.cross(points, lines @ turn)])
        inward = (np.cross(spin, np.cross(spin, points)) * (lines @ turn)).sum(axis=1)
        moves = np.where(acts, masses, 0.0)
        whole = np.zeros((6, 6))
        whole[:3, :3], whole[3:, 3:] = mass * np.eye(3), inertia
        load = rows.T @ (force - moves * inward)
        load[3:] -= np.cross(spin, state[10:13])
        gained = np.linalg.solve(whole + rows.T @ (moves[:, None] * rows), load)
        return np.concatenate([state[3:6], gained[:3], turning, inertia @ gained[3:]])

    state, time = np.zeros(13), 0.0
    state[6] = 1.0
    while acts.any():
        events = []
        for number in np.flatnonzero(acts):

            def ends(_, state, number=number):
                return travel(state)[number] - stroke[number]

            ends.terminal = True
            events.append(ends)
        found = solve_ivp(
            change, (time, 1.0), state, "DOP853", events=events, rtol=1e-12, atol=1e-14
        )
        time, state = found.t[-1], found.y[:, -1]
        acts &= travel(state) < stroke - 1e-10
    # free flight changes the rate too, so the end is a common time
    found = solve_ivp(change, (time, time + ENOUGH), state, "DOP853", rtol=1e-12, atol=1e-14)
    state = found.y[:, -1]
    return Free(time + ENOUGH, state[3:6], np.linalg.solve(inertia, state[10:13]))
