"""Between two steps: put rails to rest, or step them again.

Linear and angular momentum and mass centre of the whole system do not change. The rigid part of a
free platform takes the differences; with a fixed platform the ground takes them. The lost energy is
entered as released; at the exit it is the energy of the rails' vibration. A rail that is stepped
again gets the static deflection under the platform's present acceleration. Its energy is not taken
from the platform, so the released energy is negative, about -1e-7 J.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.dynamics import observe
from tipoff.highfi.dynamics.elastic import elastic_force
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.dynamics.system import System
from tipoff.highfi.state.records import TOTAL, State
from tipoff.kernels import rotation
from tipoff.kernels.memory import zeros


class _Motion(NamedTuple):
    """Sums over the platform and the nodes that are stepped, in inertial axes."""

    momentum: np.ndarray  # (3,) kg m/s
    moment: np.ndarray  # (3,) kg m2/s, about the scene origin
    energy: float  # J, kinetic and strain


def regroup(rails: Rails, stepper: Stepper, rests: np.ndarray, terms: np.ndarray) -> None:
    """Let the rails ``rests`` (rails,) rest and step all others.

    Velocities are those of half a step ago. Rails that are woken get the static deflection under
    ``terms`` (``statics.inertial``). Contact must not act on rails that change.
    """
    state, active, old = stepper.state, stepper.active, stepper.now
    system, team = stepper.setup.system, stepper.setup.team
    before, centre = _motion(old, state, team), _unloaded(old, state)
    changed = stepper.rests != rests
    blocks = np.concatenate([rails.blocks[k] for k in np.flatnonzero(changed)])
    state.reaction[:] -= _reactions(state, blocks)
    stepper.rests[:] = rests
    now = stepper.now
    for rail in np.flatnonzero(changed).tolist():
        _still(system, state, rails.blocks[rail])
        if not rests[rail]:
            _wake(system, rails, rail, old, state, terms)
    awake = np.concatenate(
        [np.zeros(0, np.int64), *(part for part, still in zip(rails.blocks, rests) if not still)]
    )
    state.stepped.block[: awake.size], state.stepped.in_use[0] = np.sort(awake), awake.size
    _load(system, state, blocks, team)
    state.reaction[:] += _reactions(state, blocks)
    state.rail_momentum[:] = now.moving_mass @ state.velocity
    state.rail_moment[:] = now.moving_mass @ (system.rail.points + state.displacement)
    active.rests[:] = rails.groups[rests].any(axis=0)
    active.near[:], active.wait[:] = False, 0
    _balance(now, state, before, centre, team)


def _origin(system: System, state: State) -> np.ndarray:
    """Place (3,) m of the frame's origin."""
    if system.frame is None:
        return np.zeros(3)
    base = rotation.single(state.platform.quaternion)
    return state.platform.position - base @ system.frame.centre


def _unloaded(system: System, state: State) -> np.ndarray:
    """Place (3,) m of the frame's origin if the stepped nodes had no displacement and the mass
    centre of the whole system stayed in place."""
    if system.frame is None:
        return np.zeros(3)
    shift = system.moving_mass @ state.displacement / system.frame.total_mass
    return _origin(system, state) + rotation.single(state.platform.quaternion) @ shift


def _motion(system: System, state: State, team) -> _Motion:
    base, frame = rotation.single(state.platform.quaternion), system.frame
    part = system.nodes
    velocity, mass = state.velocity[part], system.moving_mass[part]
    places = system.rail.points[part] + state.displacement[part]
    momentum = base @ (mass @ velocity)
    moment = base @ np.cross(places, velocity).T @ mass
    energy = 0.5 * float(mass @ (velocity**2).sum(axis=1)) + observe.strain(system, state, team)
    moment = moment + np.cross(_origin(system, state), momentum)
    if frame is not None:
        own, spin = frame.mass * state.platform.velocity, base.T @ state.platform.spin
        momentum = momentum + own
        moment = moment + np.cross(state.platform.position, own) + state.platform.spin
        energy += 0.5 * own @ state.platform.velocity + 0.5 * spin @ frame.inverse_inertia @ spin
    return _Motion(momentum, moment, float(energy))


def _reactions(state: State, blocks: np.ndarray) -> np.ndarray:
    """Contribution (6,) of ``blocks`` to ``State.reaction``."""
    found = state.clamping[blocks].sum(axis=0)
    found[3:] -= state.turning[blocks].sum(axis=0)
    found -= state.mounting[blocks].sum(axis=0)
    if state.history.loss.size:
        found -= state.history.drag[blocks].sum(axis=0)
    return found


def _parts(system: System, blocks: np.ndarray) -> list[slice]:
    return [slice(system.rail.blocks[block], system.rail.blocks[block + 1]) for block in blocks]


def _still(system: System, state: State, blocks: np.ndarray) -> None:
    """Set ``blocks`` to rest in their frame, without forces."""
    for part in _parts(system, blocks):
        for array in (state.displacement, state.velocity, state.resistance):
            array[part] = 0.0
        if state.history.loss.size:
            for array in (state.history.displacement, state.history.elastic, state.history.force):
                array[part] = 0.0
    for sums in (state.turning, state.clamping, state.mounting):
        sums[blocks] = 0.0
    if state.history.loss.size:
        for sums in (state.history.drag, state.history.loss, state.history.mounting):
            sums[blocks] = 0.0


def _wake(
    system: System, rails: Rails, rail: int, now: System, state: State, terms: np.ndarray
) -> None:
    """Give the nodes of a rail the velocity of the platform and their static deflection."""
    if now.frame is None:
        return
    base = rotation.single(state.platform.quaternion)
    velocity = base.T @ state.platform.velocity
    rate = now.frame.inverse_inertia @ (base.T @ state.platform.spin)
    for part in _parts(system, rails.blocks[rail]):
        arm = system.rail.points[part] - now.frame.centre
        state.velocity[part] = velocity + np.cross(rate, arm)
    for deflection in rails.deflections[rail]:
        state.displacement[system.number[deflection.own]] = deflection.under(terms)


def _load(system: System, state: State, blocks: np.ndarray, team) -> None:
    """Elastic forces of ``blocks``, which rest or were just woken, and the sums over them."""
    if not state.displacement.any():
        return
    force, turn = zeros(state.displacement.shape, order="F"), np.empty_like(state.turning)
    joints = np.zeros_like(state.mounting)
    elastic_force(system.rail, state.displacement, force, turn, joints, team)
    for block, part in zip(blocks, _parts(system, blocks)):
        state.turning[block], state.resistance[part] = turn[block], force[part]
        state.mounting[block] = joints[block]
        _keep(state, block, part)
        held = system.rail.clamped[
            system.rail.first_clamped[block] : system.rail.first_clamped[block + 1]
        ]
        on_held = force[held]
        state.clamping[block, :3] = on_held.sum(axis=0)
        state.clamping[block, 3:] = np.cross(system.rail.points[held], on_held).sum(axis=0)
        state.resistance[held] = 0.0


def _keep(state: State, block: int, part: slice) -> None:
    """Set the forces and places of the step before to the present ones."""
    if state.history.loss.size:
        state.history.displacement[part] = state.displacement[part]
        state.history.elastic[part] = state.resistance[part]
        state.history.mounting[block] = state.mounting[block]


def _balance(now: System, state: State, before: _Motion, centre: np.ndarray, team) -> None:
    """Give the rigid part, or the ground, the momentum that the nodes lost, and enter the
    energy."""
    base, frame = rotation.single(state.platform.quaternion), now.frame
    if frame is not None:
        shift = now.moving_mass @ state.displacement / frame.total_mass
        state.platform.position[:] = centre + base @ (frame.centre - shift)
        state.platform.velocity[:] = state.platform.spin[:] = 0.0
        left = _motion(now, state, team)
        momentum = before.momentum - left.momentum
        state.platform.velocity[:] = momentum / frame.mass
        state.platform.spin[:] = (
            before.moment - left.moment - np.cross(state.platform.position, momentum)
        )
    after = _motion(now, state, team)
    if frame is None:
        state.impulse[:3] += after.momentum - before.momentum
        state.impulse[3:] += after.moment - before.moment
    state.work[TOTAL]["released"] += before.energy - after.energy
