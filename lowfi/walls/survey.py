"""Which faces press walls that give way, how deep, and which of them are over a wall at all."""

import numpy as np

from lowfi import state as slot
from lowfi.touch import approach, relative_motion, relative_pose
from lowfi.walls.cells import deepest, reaches, take_lever
from lowfi.walls.record import BY_ETA, BY_XI, DEPTH, MIDDLE
from lowfi.walls.solution import follow, solve
from scenes.jit import inlined, kernel


@kernel
def depth(walls, faces, face, active, place, turn):
    """Deepest penetration (m) of a face: negative across the gap, which other faces on the rail may narrow. ``active`` (f,) tells which
    faces press."""
    count = solve(walls, faces, walls.rail[face], active, place, turn)
    return _depth(walls, faces, face, count, active, place, turn)


@kernel
def _depth(walls, faces, face, count, active, place, turn):
    """The same after ``solve``. A face that is far, and whose wall nothing moves, only tells how far at most."""
    if not active[face]:
        take_lever(walls, faces, face, place, turn)
    lever = walls.room.lever[face]
    if not reaches(walls, face, lever[MIDDLE]):
        return -np.inf
    highest = lever[DEPTH] + abs(lever[BY_XI]) + abs(lever[BY_ETA])
    if active[face]:
        return deepest(walls, face, walls.room.displacement[face])
    if count == 0 and highest < 0.0:
        return highest
    displacement = walls.room.displacement[face]
    follow(walls, face, place[0] + faces[0, 0], count, displacement)
    return deepest(walls, face, displacement)


@kernel
def survey(walls, faces, platform, payload, active, state, columns, out):
    """Fill ``columns`` (mode of an open face, of a pressing one; column of mode, depth, closing, X) of ``out``."""
    body, base = slot.motion(payload.mass, payload.inverse_inertia, state, slot.PAYLOAD), slot.frame(platform, state)
    place, turn = relative_pose(platform, body, base)
    drift, swing = relative_motion(platform, body, base, place, turn)
    open_, pressing, mode, penetration, closing, along = columns
    for rail in range(walls.members.shape[0]):
        count = solve(walls, faces, rail, active, place, turn)
        for k in range(walls.members.shape[1]):
            face = walls.members[rail, k]
            if face >= 0:
                p = _depth(walls, faces, face, count, active, place, turn)
                out[face, mode], out[face, penetration] = pressing if p > 0.0 else open_, p
                out[face, closing], out[face, along] = approach(faces[face], drift, swing), walls.room.lever[face, MIDDLE]


@inlined
def on_walls(walls, along, surveyed, engaged):
    """Bring ``engaged`` (f,) up to date: the faces of which any part is over a wall. True when any changed."""
    changed = False
    for i in range(engaged.size):
        inside = reaches(walls, i, surveyed[i, along])
        changed = changed or inside != engaged[i]
        engaged[i] = inside
    return changed
