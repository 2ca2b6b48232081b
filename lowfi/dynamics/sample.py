"""One sample of a run: places, velocities, rates, energies and momenta of a state, and the force on
every pad face."""

import numpy as np

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact import stick_slip as grips
from tipoff.lowfi.contact.compliant.loads import energy as wall_energy
from tipoff.lowfi.contact.compliant.loads import lean
from tipoff.lowfi.contact.compliant.loads import load as wall_load
from tipoff.lowfi.contact.compliant.modes import energies
from tipoff.lowfi.contact.compliant.solution import solve
from tipoff.lowfi.contact.springs import along, load, pad_point, penetration, relative_pose
from tipoff.lowfi.dynamics.events import stored
from tipoff.lowfi.state import (
    IMPULSE,
    MOMENT,
    PAYLOAD,
    PLACE,
    PLATFORM,
    VELOCITY,
    WORK,
    WORK_SIZE,
    Motion,
)
from tipoff.lowfi.system import HALF_LENGTH

# Slots of a sample: payload and platform first (place, velocity, quaternion, rate in body axes),
# each BODY_SIZE long.
RATE = slot.MOMENT  # where the state holds angular momentum the sample holds the rate
KINETIC, AXIAL_KINETIC, STORED, STRAIN, WORKS = 26, 27, 28, 29, 30
LINEAR, ANGULAR, GIVEN = WORKS + WORK_SIZE, WORKS + WORK_SIZE + 3, WORKS + WORK_SIZE + 6
SAMPLE_SIZE = GIVEN + 6


@kernel
def observe(system, engaged, active, grip, state, row, forces):
    """Fill ``row`` (SAMPLE_SIZE,) and ``forces`` (f,3) N on the payload in scene axes; False where
    a number is not finite. Walls that give way are pressed by the ``active`` faces (f,)."""
    payload = system.payload
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, PAYLOAD),
        slot.frame(system.platform, state),
    )
    row[:] = 0.0
    _place(state, body, base, row)
    _body(payload.mass, state[:PLATFORM], body, row)
    _platform(system.platform, state, base, row)
    row[STORED] = _press(
        system.contact,
        system.friction,
        system.sticking,
        system.faces,
        system.platform,
        engaged,
        grip,
        body,
        base,
        forces,
    )
    row[STORED] += _press_walls(
        system.compliance,
        system.friction,
        system.faces,
        system.platform,
        active,
        body,
        base,
        state,
        forces,
    )
    _rails(system.compliance, state, row)
    slot.copy(state[WORK:], row[WORKS:], WORK_SIZE)
    slot.copy(state[IMPULSE:], row[GIVEN:], 6)
    total = 0.0
    for value in row:
        total += abs(value)
    for i in range(engaged.size):
        total += abs(forces[i, 0]) + abs(forces[i, 1]) + abs(forces[i, 2])
    return np.isfinite(total)


@inlined
def posture(system, state, row):
    """Fill only what ``row`` tells of the motion: its first two bodies."""
    _place(
        state,
        slot.motion(system.payload.mass, system.payload.inverse_inertia, state, PAYLOAD),
        slot.frame(system.platform, state),
        row,
    )


@inlined
def payload_rates(payload, state, row):
    """Fill only the payload's part of ``row``."""
    _copy(
        state[:PLATFORM],
        slot.motion(payload.mass, payload.inverse_inertia, state, PAYLOAD),
        row[:PLATFORM],
    )


@inlined
def _place(state, body, base, row):
    _copy(state[:PLATFORM], body, row[:PLATFORM])
    _copy(state[PLATFORM:], base, row[PLATFORM:])


@inlined
def rearmost_edge(faces, platform, row):
    """X (m) in platform axes of the rearmost trailing edge of the pads."""
    place, turn = slot.triple(row, PAYLOAD + PLACE), rotation.matrix(slot.quaternion(row, PAYLOAD))
    body = Motion(place, place, turn, place)
    base_place, base_turn = (
        slot.triple(row, PLATFORM + PLACE),
        rotation.matrix(slot.quaternion(row, PLATFORM)),
    )
    place, turn = relative_pose(
        platform, body, Motion(base_place, base_place, base_turn, base_place)
    )
    rearmost = np.inf
    for i in range(faces.shape[0]):
        rearmost = min(rearmost, along(faces[i], place, turn) - turn[0] * faces[i, HALF_LENGTH])
    return rearmost


@inlined
def _copy(state, body, row):
    """Places and velocities of one body, whose slots stand first in ``state`` and ``row``."""
    slot.copy(state, row, slot.MOMENT)
    rate = rotation.unrotate(body.turn, body.rate)
    for i in range(3):
        row[RATE + i] = rate[i]


@kernel
def _platform(platform, state, base, row):
    if platform is not None:
        _body(platform.mass, state[PLATFORM:], base, row)


@kernel
def _body(mass, state, body, row):
    """Add kinetic energy and momenta of one body."""
    moment, orbit = slot.triple(state, MOMENT), rotation.cross(body.place, body.velocity)
    spin = (moment[0] - mass * orbit[0], moment[1] - mass * orbit[1], moment[2] - mass * orbit[2])
    row[KINETIC] += 0.5 * (
        mass * rotation.dot(body.velocity, body.velocity) + rotation.dot(spin, body.rate)
    )
    row[AXIAL_KINETIC] += 0.5 * mass * body.velocity[0] * body.velocity[0]
    for i in range(3):
        row[LINEAR + i] += mass * state[VELOCITY + i]
        row[ANGULAR + i] += moment[i]


@kernel
def _press(laws, friction, sticking, faces, platform, engaged, grip, body, base, forces):
    """Fill ``forces``; the energy (J) stored in all faces."""
    energy = 0.0
    forces[:] = 0.0
    if laws is not None:
        place, turn = relative_pose(platform, body, base)
        for i in range(engaged.size):
            if engaged[i]:
                p = penetration(laws.bow, faces[i], place, turn)
                if p > 0.0:
                    face = load(laws, friction, platform, faces[i], p, body, base)
                    energy += stored(laws, p)
                    for j in range(3):
                        forces[i, j] = face.normal[j] + face.drag[j]
                    _add_grip(sticking, grip, i, faces, face, base, forces[i])
        energy += _in_grips(sticking, grip, faces, body, base)
    return energy


@kernel
def _press_walls(compliance, friction, faces, platform, active, body, base, state, forces):
    """The same on walls that give way. A sample leaves no trace:
    the next step begins with the displacement that the last one left."""
    energy = 0.0
    if compliance is not None:
        _keep(compliance.room.displacement, compliance.room.kept)
        place, turn = relative_pose(platform, body, base)
        for rail in range(compliance.members.shape[0]):
            count = solve(compliance, faces, rail, active, place, turn, state)
            energy += wall_energy(compliance, count)
            for k in range(count):
                i = compliance.room.order[k]
                if compliance.room.force[i, 0] > 0.0:
                    face = wall_load(compliance, friction, platform, faces, i, body, base)
                    aside, _ = lean(compliance, faces, i, body, base)
                    for j in range(3):
                        forces[i, j] = face.normal[j] + face.drag[j] + aside[j]
        _keep(compliance.room.kept, compliance.room.displacement)
    return energy


@inlined
def _rails(compliance, state, row):
    """Add the energies of the rails' modes."""
    if compliance is not None:
        kinetic, strain = energies(compliance.modes, state)
        row[KINETIC] += kinetic
        row[STRAIN] = strain


@inlined
def _keep(source, target):
    for i in range(source.shape[0]):
        slot.copy(source[i], target[i], source.shape[1])


@kernel
def _add_grip(sticking, grip, number, faces, face, base, force):
    if sticking is not None:
        drag, _ = grips.traction(sticking, grip[number], faces[number], face, base)
        for j in range(3):
            force[j] += drag[j]


@kernel
def _in_grips(sticking, grip, faces, body, base):
    """Energy (J) in the springs of all faces."""
    energy = 0.0
    if sticking is not None:
        for i in range(faces.shape[0]):
            energy += grips.kept(sticking, grip[i], faces[i], pad_point(faces[i], body), base)
    return energy
