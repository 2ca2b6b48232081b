"""The payload at rest on its rails: statics of its pose and of the vibrating rails, before the
run.

Place across the rail, attitude and modal amplitudes x solve F(x) = 0, with the forces, moments and
modal forces of the equations of motion at rest. The travel is given. Newton's method is damped as
the motion over a time t from rest::

    (M / t^2 - dF/dx) dx = F

so that a payload without contact falls towards its walls. The time grows as the forces vanish.
"""

import itertools

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import entry
from tipoff.lowfi import state as slot
from tipoff.lowfi.dynamics.cases import Cases, system_of
from tipoff.lowfi.dynamics.equations import derivative
from tipoff.lowfi.dynamics.integrate import reset
from tipoff.lowfi.dynamics.loop import Loop, allocate
from tipoff.lowfi.system import System
from tipoff.mechanics.lowered import lowered
from tipoff.mechanics.model import Model
from tipoff.scenes.settled import no_rest

LONG_AGO = -1e9  # s: no thrust acts yet
AT_REST = 1e-10  # largest force over the weight, and moment over weight times reach
_MOST = 400  # corrections
_FURTHER = 60  # corrections towards a place of rest after one where the payload only slides slowly
_NUDGE = 1e-9  # m, of a derivative
_LONGEST = 2e-5  # m, of a correction
_FIRST, _LAST = 1e-4, 1.0  # s, times of the damping
# Weights per metre, less than which holds nothing in its place; and largest force over the weight with which
# a payload slides, as in the reference
_LOOSE, _SLOW = 10.0, 1e-3
_HALVINGS, _NEAR = 30, 1e-2  # of a correction, and largest force over the weight near rest
_FIRM = 1e-8  # largest force over the weight where something holds it, beside such a force
_RIGID = 5  # place along Y and Z, turns about X, Y and Z


@entry
def forces(common, cases, loop, state, out):
    """Fill ``out`` (STATE_SIZE + modes,) with the derivative of ``state``, the first of the
    ``cases`` at rest. All faces over their walls may touch."""
    system = system_of(common, cases, 0)
    reset(system, state, 1.0, loop)
    for i in range(loop.touching.size):
        loop.touching[i] = loop.engaged[i]
    derivative(system, loop.touching, loop.stick, loop.counts.apart, LONG_AGO, loop.end, out)


def rest(name: str, common: System, cases: Cases, model: Model) -> np.ndarray:
    """State (STATE_SIZE + modes,) of the first of the ``cases``, that of ``model``, at rest on its
    rails. Raises SceneError, naming the scene, if there is no such place."""
    return _Rest(common, cases, model).found(name)


class _Rest:
    def __init__(self, common: System, cases: Cases, model: Model):
        self.common, self.cases = common, cases
        self.loop: Loop = allocate(common)
        self.begun = np.zeros(self.loop.start.size)
        self.begun[: slot.STATE_SIZE] = cases.start[0]
        self.out = np.zeros(self.begun.size)
        self.modes = (self.begun.size - slot.STATE_SIZE) // 2
        self.reach, self.mass = float(cases.reach[0]), float(cases.mass[0])
        weight = model.body_force
        assert weight is not None  # since settled.require
        self.pull = self.mass * float(np.linalg.norm(weight))
        place = self.begun[slot.PLACE : slot.PLACE + 3]
        attitude = self.begun[slot.QUATERNION : slot.QUATERNION + 4]
        place[:] = lowered(model.faces, place, attitude, weight)
        inertia = np.diag(cases.inertia[0])
        self.masses = np.concatenate([[self.mass] * 2, inertia, np.ones(self.modes)])
        # lengths in units of the nudge, so that all columns are of one size
        turns = [1.0 / self.reach] * 3
        self.sizes = np.concatenate([[1.0, 1.0], turns, np.ones(self.modes)])

    def state(self, moved: np.ndarray) -> np.ndarray:
        """The state moved by ``moved`` (_RIGID + modes,) from the stated one."""
        found = self.begun.copy()
        place = found[slot.PLACE : slot.PLACE + 3] + np.append(0.0, moved[:2])
        attitude = rotation.product(
            rotation.exponential(tuple(moved[2:_RIGID])),
            tuple(self.begun[slot.QUATERNION : slot.QUATERNION + 4]),
        )
        at_rest, inertia = (0.0, 0.0, 0.0), self.cases.inertia[0]
        unit = rotation.normalised(attitude)
        slot.fill(found, slot.PAYLOAD, inertia, tuple(place), at_rest, unit, at_rest)
        found[slot.STATE_SIZE : slot.STATE_SIZE + self.modes] = moved[_RIGID:]
        return found

    def force(self, moved: np.ndarray) -> np.ndarray:
        """Forces (N) along Y and Z, moments (N m) in scene axes, and modal forces."""
        state = self.state(moved)
        forces(self.common, self.cases, self.loop, state, self.out)
        across = self.mass * self.out[slot.VELOCITY + 1 : slot.VELOCITY + 3]
        turn = np.array(rotation.matrix(tuple(state[slot.QUATERNION : slot.QUATERNION + 4])))
        moment = turn.reshape(3, 3) @ self.out[slot.SPIN : slot.SPIN + 3]
        rates = slot.STATE_SIZE + self.modes
        return np.concatenate([across, moment, self.out[rates : rates + self.modes]])

    def _slopes(self, moved: np.ndarray, force: np.ndarray) -> np.ndarray:
        """dF/dx (n,n) by differences."""
        columns = []
        for i, size in enumerate(_NUDGE * self.sizes):
            other = moved.copy()
            other[i] += size
            columns.append((self.force(other) - force) / size)
        return np.array(columns).T

    def _left(self, force: np.ndarray) -> float:
        """Largest force over the weight."""
        return float(np.abs(force / self._scale()).max())

    def _scale(self) -> np.ndarray:
        """The weight, and its moment at the reach of the payload, as the sizes of forces."""
        return self.pull * np.concatenate([[1.0, 1.0], [self.reach] * 3, np.ones(self.modes)])

    def _slides(self, slopes: np.ndarray, force: np.ndarray) -> bool:
        """Whether the forces that are left only let the payload slide slowly where nothing holds it, such
        as across a wall by the tilt of its pads. It slides from ignition on, if friction lets it."""
        scale = self._scale()
        stiffness = -slopes * self.sizes / scale[:, None]  # weights per m
        directions, sizes, _ = np.linalg.svd(stiffness)
        left, loose = np.abs(directions.T @ (force / scale)), sizes < _LOOSE
        return bool(left[~loose].max(initial=0.0) <= _FIRM)

    def found(self, name: str) -> np.ndarray:
        """The state at rest. Where a pad is about to press, full corrections go to and fro; then each one
        near rest is halved until the force is smaller."""
        force = np.zeros(0)
        for halves in (False, True):
            state, force = self._searched(halves)
            if state is not None:
                return state
        raise no_rest(name, f"a force of {self._left(force):.2g} of the weight is left")

    def _searched(self, halves: bool) -> tuple[np.ndarray | None, np.ndarray]:
        """The state at rest, None if none is found, and the forces that are left."""
        moved, over = np.zeros(self.masses.size), _FIRST
        sliding = None  # where only a small force along free directions was left
        force, most = self.force(moved), _MOST
        for done in itertools.count():
            left = self._left(force)
            if not np.isfinite(left) or done == most:
                break
            if left <= AT_REST:
                return self.state(moved), force
            slopes = self._slopes(moved, force)
            if sliding is None and left <= _SLOW and self._slides(slopes, force):
                sliding, most = moved, min(done + _FURTHER, _MOST)
            matrix = np.diag(self.masses / over**2) - slopes
            change = np.linalg.solve(matrix, force)
            longest = float(np.abs(change / self.sizes).max())
            if longest > _LONGEST:
                change *= _LONGEST / longest
            before = moved
            for _ in range(_HALVINGS if halves and left <= _NEAR else 1):
                moved = before + change
                force = self.force(moved)
                if self._left(force) <= left:
                    break
                change = 0.5 * change
            closer = self._left(force) <= left  # as in a fall
            over = min(2.0 * over, _LAST) if closer else max(0.5 * over, _FIRST)
        return (None if sliding is None else self.state(sliding)), force
