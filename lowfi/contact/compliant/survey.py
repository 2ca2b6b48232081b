"""Which faces press walls that give way, how deep, and which of them are over a wall at all."""

import numpy as np

from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import thermal_offset
from tipoff.lowfi.contact.compliant.cells import deepest, take_lever
from tipoff.lowfi.contact.compliant.loads import energy as energy_of_rail
from tipoff.lowfi.contact.compliant.modes import speed_at
from tipoff.lowfi.contact.compliant.record import ASIDE, DRIFT, MIDDLE, SHIFT
from tipoff.lowfi.contact.compliant.solution import follow, solve
from tipoff.lowfi.contact.springs import across, approach, relative_motion, relative_pose, sideways
from tipoff.lowfi.contact.wall_ends import ALONG, CLOSING, DEPTH, FORWARD, MODE, SIDE, SIDEWAYS
from tipoff.lowfi.system import LAST_STRIP, NORMAL_Y, NORMAL_Z, SIDE_MIDDLE

_THERE = 1e-9  # m, how far beyond its aim a step goes


@kernel
def depth(compliance, faces, face, active, place, turn, state):
    """Deepest penetration (m) of a face: negative across the gap, which other faces on the rail may
    narrow. ``active`` (f,) tells which faces press."""
    count = solve(compliance, faces, compliance.rail[face], active, place, turn, state)
    return _deepest(compliance, faces, face, count, active, place, turn, state)[0]


@kernel
def _deepest(compliance, faces, face, count, active, place, turn, state):
    """The same after ``solve``, and xi and eta of the deepest cell. A face past the end has the
    depth it would have there: else a touch in the step in which it leaves would not be seen."""
    if not active[face]:
        take_lever(compliance, faces, face, place, turn)
    displacement = compliance.room.displacement[face]
    if not active[face]:
        follow(compliance, face, place[0] + faces[0, 0], count, state, displacement)
    return deepest(compliance, face, displacement)


@inlined
def _approach(compliance, faces, face, xi, eta, drift, swing):
    """Rate (m/s) at which a point of the face comes up to its wall, which only modes move."""
    y, z, half = faces[face, NORMAL_Y], faces[face, NORMAL_Z], compliance.half[face]
    turning = xi * half[0] * (y * swing[3] + z * swing[6]) + eta * half[1] * (
        y * swing[5] + z * swing[7]
    )
    along, across = (
        xi + compliance.room.lever[face, SHIFT],
        eta + compliance.room.lever[face, ASIDE],
    )
    away = (
        speed_at(compliance.modes, face, along, across)
        + thermal_offset.recess(compliance.warm, face, along, across) * drift[0]
    )
    return approach(None, faces[face], None, None, drift, swing) + turning - away


@kernel
def survey(compliance, faces, platform, payload, active, state, open_, pressing, out):
    """Fill ``out`` as ``lowfi.dynamics.events.survey`` does; ``open_`` and ``pressing`` are the modes of a
    face. The energy (J) in all walls under the ``active`` faces (f,)."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    drift, swing = relative_motion(platform, body, base, place, turn)
    total = 0.0
    for rail in range(compliance.members.shape[0]):
        count = solve(compliance, faces, rail, active, place, turn, state)
        total += energy_of_rail(compliance, count)
        for k in range(compliance.members.shape[1]):
            face = compliance.members[rail, k]
            if face >= 0:
                p, xi, eta = _deepest(compliance, faces, face, count, active, place, turn, state)
                out[face, MODE], out[face, DEPTH] = pressing if p > 0.0 else open_, p
                out[face, CLOSING] = _approach(compliance, faces, face, xi, eta, drift, swing)
                out[face, ALONG], out[face, FORWARD] = place[0] + faces[face, 0], drift[0]
                out[face, SIDE] = across(faces[face], place, turn) - faces[face, SIDE_MIDDLE]
                out[face, SIDEWAYS] = sideways(faces[face], drift, swing)
    return total


@kernel
def while_hanging(compliance, faces, platform, payload, active, state):
    """Longest step (s) where an ``active`` face (f,) comes to an end of the rail. The rate at which
    it leaves energy behind jumps as it begins to hang over and bends with every row of cells that
    leaves, which no error estimate sees; and its last strip leaves at once. So a step goes no
    farther than up to either, nor than to where a face that comes over an end is wholly over it,
    and a quarter of a cell at most."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    drift, _ = relative_motion(platform, body, base, place, turn)
    longest = np.inf
    for face in range(active.size):
        if active[face]:
            take_lever(compliance, faces, face, place, turn)
            half, middle = compliance.half[face, 0], compliance.room.lever[face, MIDDLE]
            ahead = compliance.end - middle if drift[0] > 0.0 else middle - compliance.start
            behind = middle - compliance.start if drift[0] > 0.0 else compliance.end - middle
            way = (
                np.inf
                if compliance.room.lever[face, DRIFT] == 0.0
                else 0.5 * half / compliance.node.size
            )
            for to in (ahead - half, ahead + half * (1.0 - LAST_STRIP)):
                way = min(way, to + _THERE) if to > 0.0 else way
            if half - behind > _THERE:
                way = min(way, half - behind + _THERE)
            longest = min(longest, way / abs(drift[0]))
    return longest


@kernel
def energy(compliance, faces, platform, payload, active, state):
    """Energy (J) in all walls under the ``active`` faces (f,)."""
    body, base = (
        slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    total = 0.0
    for rail in range(compliance.members.shape[0]):
        total += energy_of_rail(
            compliance, solve(compliance, faces, rail, active, place, turn, state)
        )
    return total
