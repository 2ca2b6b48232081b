"""Faces that press in compliant contact, their depth, and the longest step near the ends of a
rail."""

import numpy as np

from tipoff.kernels.jit import kernel
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import drawn_walls, thermal_offset
from tipoff.lowfi.contact.compliant.cells import (
    drawn_slope,
    drift_of_depth,
    take_lever,
)
from tipoff.lowfi.contact.compliant.deepest import deepest, deepest_at_rest
from tipoff.lowfi.contact.compliant.free_vibration import note_reach
from tipoff.lowfi.contact.compliant.loads import energy as energy_of_rail
from tipoff.lowfi.contact.compliant.modes import is_at_rest, speed_at
from tipoff.lowfi.contact.compliant.parts import way_to_jump
from tipoff.lowfi.contact.compliant.record import ASIDE, MIDDLE, SHIFT
from tipoff.lowfi.contact.compliant.solution import follow, solve, solve_unless
from tipoff.lowfi.contact.springs import (
    across,
    along,
    approach_of_straight,
    forward,
    relative_motion,
    relative_pose,
    sideways,
)
from tipoff.lowfi.contact.wall_ends import (
    ALONG,
    CLOSING,
    DEPTH,
    FORWARD,
    MODE,
    OPEN,
    PRESSING,
    SIDE,
    SIDEWAYS,
)
from tipoff.lowfi.faces import LAST_STRIP, NORMAL_Y, NORMAL_Z, SIDE_MIDDLE

_THERE = 1e-9  # m, excess of a step beyond its target
# A step to a jump of a slope ends before it, and from ``_NEAR`` (m) just beyond, for the speed changes on the way.
_NEAR, _MOST_OF_IT, _BEYOND = 1e-7, 0.99, 1e-11


@kernel
def depth(compliance, faces, face, touching, place, turn, state):
    """Deepest penetration (m) of a face, negative across the gap, which other faces on the rail may
    narrow. ``touching`` (f,) are the faces that press."""
    count = solve(compliance, faces, compliance.rail[face], touching, place, turn, state)
    return _deepest(compliance, faces, face, count, touching, place, turn, state)[0]


@kernel
def _deepest(compliance, faces, face, count, touching, place, turn, state):
    """As ``depth`` after ``solve``, and xi and eta of the deepest cell. A face past the end gets
    the depth that it would have there, so that a contact in the step in which it leaves is
    found."""
    displacement = compliance.workspace.displacement[face]
    if not touching[face]:
        take_lever(compliance, faces, face, place, turn)
        if (
            count == 0
            and is_at_rest(compliance.modes, compliance.rail[face], face, state)
            and not thermal_offset.is_warm(compliance.thermal_offset)
        ):
            displacement[:] = 0.0
            if not drawn_walls.is_drawn(compliance.drawn):
                return deepest_at_rest(compliance, face, displacement)
            return deepest(compliance, face, displacement)
        follow(compliance, face, place[0] + faces[0, 0], count, state, displacement)
    return deepest(compliance, face, displacement)


@kernel
def _approach(compliance, faces, face, xi, eta, drift, swing):
    """Rate (m/s) at which a point of the face approaches its wall, modes at rest."""
    y, z, half = faces[face, NORMAL_Y], faces[face, NORMAL_Z], compliance.half[face]
    turning = xi * half[0] * (y * swing[3] + z * swing[6]) + eta * half[1] * (
        y * swing[5] + z * swing[7]
    )
    along, across = _on_wall(compliance, face, xi, eta)
    away = thermal_offset.slope(compliance.thermal_offset, face, along, across) * drift[0]
    away += drawn_slope(compliance, face, xi, eta) * forward(faces[face], drift, swing)
    along_edge = drift_of_depth(compliance, face, xi, eta) * forward(faces[face], drift, swing)
    return approach_of_straight(faces[face], drift, swing) + turning - away + along_edge


@kernel
def _on_wall(compliance, face, xi, eta):
    """xi' and eta' on the wall under a point of the face."""
    lever = compliance.workspace.lever[face]
    return xi + lever[SHIFT], eta + lever[ASIDE]


@kernel
def _speed_of_modes(compliance, face, xi, eta):
    """Rate (m/s) at which modes move the wall away from a point of the face."""
    along, across = _on_wall(compliance, face, xi, eta)
    return speed_at(compliance.modes, face, along, across)


@kernel
def survey(compliance, faces, platform, payload, touching, state, solved, out):
    """Fill ``out`` (f, SURVEY_SIZE), as ``lowfi.dynamics.survey`` does; returns the energy (J)
    stored under the ``touching`` faces (f,)."""
    body, base = (
        slot.motion(payload, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    drift, swing = relative_motion(platform, body, base, place, turn)
    total = 0.0
    for rail in range(compliance.members.shape[0]):
        count = solve_unless(solved, compliance, faces, rail, touching, place, turn, state)
        total += energy_of_rail(compliance, count)
        for k in range(compliance.members.shape[1]):
            face = compliance.members[rail, k]
            if face >= 0:
                p, xi, eta = _deepest(compliance, faces, face, count, touching, place, turn, state)
                out[face, MODE], out[face, DEPTH] = PRESSING if p > 0.0 else OPEN, p
                speed = _speed_of_modes(compliance, face, xi, eta)
                out[face, CLOSING] = (
                    _approach(compliance, faces, face, xi, eta, drift, swing) - speed
                )
                note_reach(compliance.modes, rail, face, count, speed, state, out[face])
                out[face, ALONG] = along(faces[face], place, turn)
                out[face, FORWARD] = forward(faces[face], drift, swing)
                out[face, SIDE] = across(faces[face], place, turn) - faces[face, SIDE_MIDDLE]
                out[face, SIDEWAYS] = sideways(faces[face], drift, swing)
    return total


@kernel
def longest_step_at_ends(compliance, faces, platform, payload, touching, state):
    """Longest step (s) if a ``touching`` face (f,) is near an end of the rail. The force of the end
    jumps when the face begins to overhang, and the slope of the compliance there and where the part of
    the face with a wall stops to shrink. No error estimate sees this. The last strip of the face
    leaves at once. So a step ends there at the latest, and where a face that comes over an end is
    completely over it."""
    body, base = (
        slot.motion(payload, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    drift, swing = relative_motion(platform, body, base, place, turn)
    longest = np.inf
    for face in range(touching.size):
        if touching[face]:
            take_lever(compliance, faces, face, place, turn)
            half, middle = compliance.half[face, 0], compliance.workspace.lever[face, MIDDLE]
            speed = forward(faces[face], drift, swing)
            ahead = compliance.end - middle if speed > 0.0 else middle - compliance.start
            behind = middle - compliance.start if speed > 0.0 else compliance.end - middle
            way = np.inf
            for to in (ahead - half, ahead + half * (1.0 - LAST_STRIP)):
                way = min(way, to + _THERE) if to > 0.0 else way
            if half - behind > _THERE:
                way = min(way, half - behind + _THERE)
            longest = min(longest, way / abs(speed))
            jump = way_to_jump(compliance, face, place[0] + faces[0, 0], drift[0])
            jump = jump + _BEYOND if jump < _NEAR else _MOST_OF_IT * jump
            longest = min(longest, jump / abs(drift[0]))
    return longest


@kernel
def energy(compliance, faces, platform, payload, touching, state):
    """Energy (J) stored under the ``touching`` faces (f,)."""
    body, base = (
        slot.motion(payload, state, slot.PAYLOAD),
        slot.frame(platform, state),
    )
    place, turn = relative_pose(platform, body, base)
    total = 0.0
    for rail in range(compliance.members.shape[0]):
        total += energy_of_rail(
            compliance, solve(compliance, faces, rail, touching, place, turn, state)
        )
    return total
