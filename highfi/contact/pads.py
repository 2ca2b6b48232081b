"""Contact of the crowned, rigid pad faces with the Gauss points of the rail's surface facets.

For a point y in payload axes, with local face coordinates xi, eta in [-1, 1] and outward height h
over the flat face::

    p = -h - relief (xi^4 + eta^4),      potential k_p p^2 / 2 per area for p > 0

The force on the rail is minus the full gradient of that potential (so it has the small tangential
part that the crown's slope calls for) and the contact stores energy exactly. The opposite force
acts on the payload at the same point. Friction uses the shared law with the half-step sliding
velocity. Only what can touch is computed: a facet whose control points (``facets``; its four
corners, or those of a curved triangle) lie outside the uncrowned face plane is passed over, since
no Gauss point in their hull can have crossed it, and a face whose nearest control point is a gap
away is not looked at until something approaching at ``FASTEST_APPROACH`` could have closed it. That
speed is checked at every sample.

A wall is a plate: what is behind its surface by its thickness or more is behind the wall and feels
nothing. A face that was over no wall, or behind it, may come over it with a penetration of
``ROUNDED`` at most; what comes deeper strikes an edge or the back of the wall (``lowfi.contact.wall_ends`` has
the same rule for rigid walls), where no contact is modelled: it feels nothing, and the run ends.

Faces that can share a node make a group, as those along one rail do. Groups have nothing in common
and are shared out among threads; their loads are added up in one order, whoever computed them.
"""

import numpy as np

from tipoff.highfi.contact.facet import Touch, is_off, lowest, press, probe, rate_damping
from tipoff.highfi.state.nodes import follow_frame
from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import (
    AWAY,
    BORDER,
    DAMPING_RATIO,
    FRICTION_FORCE,
    FRICTION_MOMENT,
    GAINED,
    LOAD_SIZE,
    NODES,
    OVER,
    RELEASED,
    UNKNOWN,
)
from tipoff.highfi.state.threads import take
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel

# m/s across the rail: a face this far from every facet is not looked at before it could arrive
FASTEST_APPROACH = 10.0
ROUNDED = 1e-6  # m: no edge of a pad or a wall is sharper
# m: over so much way on either side a face comes over the first points of its wall, which deforms
# by less
_ENTRY = 1e-4
_MARGIN = 1e-3  # m along the rail by which the searched window is wider than the face


@kernel
def contact_forces(rail, surface, faces, frame, penalty, friction, state, active, pose, team, dt):
    """Fill ``state.contact``, ``state.loads``, ``state.face_force`` and ``active``; every thread of
    ``team`` takes a part of it."""
    if penalty is not None:
        group = take(team)
        while group < surface.groups.first_face.size - 1:
            _forces_of_group(
                rail, surface, faces, frame, penalty, friction, state, active, pose, group, dt
            )
            group = take(team)


@kernel
def _forces_of_group(
    rail, surface, faces, frame, penalty, friction, state, active, pose, group, dt
):
    touch = Touch(
        surface.places,
        rail.inverse_mass,
        state.displacement,
        state.velocity,
        state.contact,
        state.loads[group],
        state.face_force,
    )
    touch.load[:] = 0.0
    groups = surface.groups
    follow_frame(
        rail,
        state,
        frame,
        groups.clamped,
        groups.first_clamped[group],
        groups.first_clamped[group + 1],
    )
    _release_over_the_edge(touch, surface, faces, group, active, pose)
    _forget(surface, group, active)
    for k in range(groups.first_face[group], groups.first_face[group + 1]):
        _look(touch, surface, faces, groups.face[k], group, penalty, friction, active, pose, dt)
    rate_damping(touch, surface, friction, group, active, dt)


@kernel
def _forget(surface, group, active):
    first = surface.groups.first_node[group]
    for k in range(first, first + active.count[group, NODES]):
        node = active.node[k]
        active.seen[node] = False
        active.node_damping[node] = 0.0
        for i in range(3):
            active.drag[node, i] = 0.0
    active.count[group, BORDER] = 0
    active.count[group, NODES] = 0


@inlined
def _look(touch, surface, faces, face, group, penalty, friction, active, pose, dt):
    """Forces of one face, if it can touch by now."""
    touch.face_force[face, 0], touch.face_force[face, 1], touch.face_force[face, 2] = 0.0, 0.0, 0.0
    if active.struck[face, 0] > 0.0:
        active.struck[face, 2] += 1.0
    elif active.wait[face] > 0:
        active.wait[face] -= 1
    else:
        place = rotation.rotate(
            pose.turn, (faces.centre[face, 0], faces.centre[face, 1], faces.centre[face, 2])
        )
        x = place[0] + pose.centre[0]
        half = faces.half_length[face] + _MARGIN
        first, last = surface.first[face], surface.first[face + 1]
        window = surface.start[first:last]
        low = first + np.searchsorted(window, x - half - surface.longest)
        high = first + np.searchsorted(window, x + half)
        gap = _MARGIN
        _mind_the_wall(
            touch,
            surface,
            faces,
            face,
            low,
            high,
            x,
            _overlap(surface, faces, face, place, pose),
            active,
            pose,
        )
        for k in range(low, high):
            facet = surface.reach[k]
            height = lowest(touch, surface, surface.control, faces, face, facet, pose)
            gap = min(gap, height)
            if height < 0.0 and active.struck[face, 0] == 0.0:
                press(
                    touch, surface, faces, face, facet, group, penalty, friction, active, pose, dt
                )
        active.wait[face] = max(0, int(gap / (FASTEST_APPROACH * dt)) - 1)


@inlined
def _overlap(surface, faces, face, place, pose):
    """By how much (m) a face reaches over the border of its wall's points, along or across the
    rail, whichever is less."""
    axis, border = 3 - faces.axis[face], surface.border[face]
    x, y = (
        place[0] + pose.centre[0],
        place[1] + pose.centre[1] if axis == 1 else place[2] + pose.centre[2],
    )
    along = min(x + faces.half_length[face] - border[0], border[1] - x + faces.half_length[face])
    return min(
        along, y + faces.half_width[face] - border[2], border[3] - y + faces.half_width[face]
    )


@inlined
def _mind_the_wall(touch, surface, faces, face, low, high, x, overlap, active, pose):
    """Bring ``active.side`` up to date, and ``active.struck`` where a face with its middle at ``x``
    (m) comes from nowhere into its wall, of which it may meet facets ``low`` to ``high``."""
    if overlap < -_ENTRY:
        active.side[face] = AWAY
    elif active.side[face] != OVER:
        inside, behind = 0.0, 0.0
        for k in range(low, high):
            found = probe(touch, surface, faces, face, surface.reach[k], pose)
            inside, behind = max(inside, found[0]), max(behind, found[1])
        if active.side[face] == AWAY and inside > ROUNDED:
            active.struck[face, 0], active.struck[face, 1] = inside, x
        elif behind >= surface.thickness:
            active.side[face] = AWAY
        elif overlap > _ENTRY or active.side[face] == UNKNOWN:
            active.side[face] = OVER


@kernel
def _release_over_the_edge(touch, surface, faces, group, active, pose):
    """Energy of points that carried load a step ago and are no longer under their face counts as
    gained by nobody: released."""
    first = surface.groups.first_point[group]
    for k in range(first, first + active.count[group, BORDER]):
        if is_off(
            touch, surface, faces, active.face[k], active.point[k, 0], active.point[k, 1], pose
        ):
            touch.load[GAINED] -= active.energy[k]


@kernel
def collect_contact(rail, surface, state, active):
    """Sum up loads, move contact forces of moving nodes into the resistance and ``state.reaction``,
    released energy into work."""
    state.load[:] = 0.0
    for group in range(surface.groups.first_face.size - 1):
        for slot in range(LOAD_SIZE):
            state.load[slot] = _combined(slot, state.load[slot], state.loads[group, slot])
        first = surface.groups.first_node[group]
        for k in range(first, first + active.count[group, NODES]):
            _collect_node(rail, state, active.node[k])
    state.work[RELEASED] -= state.load[GAINED]


@inlined
def _combined(slot, total, part):
    return max(total, part) if slot == DAMPING_RATIO else total + part


@inlined
def _collect_node(rail, state, node):
    f = (state.contact[node, 0], state.contact[node, 1], state.contact[node, 2])
    if rail.inverse_mass[node] > 0.0:
        x, u = triple(rail.points[node]), triple(state.displacement[node])
        moment = rotation.cross((x[0] + u[0], x[1] + u[1], x[2] + u[2]), f)
        for i in range(3):
            state.resistance[node, i] += f[i]
            state.reaction[i] -= f[i]
            state.reaction[3 + i] -= moment[i]
    for i in range(3):
        state.contact[node, i] = 0.0


@kernel
def friction_power(rail, surface, state, active, pose, friction, pull, ahead):
    """Power (W) of the present friction at the velocities of ``pose`` and those of the nodes once
    kicked over ``ahead`` (s)."""
    power = 0.0
    if friction is not None:
        for i in range(3):
            power += (
                state.load[FRICTION_FORCE + i] * pose.velocity[i]
                + state.load[FRICTION_MOMENT + i] * pose.rate[i]
            )
        for group in range(surface.groups.first_face.size - 1):
            first = surface.groups.first_node[group]
            for k in range(first, first + active.count[group, NODES]):
                power -= _power_on_node(rail, state, active, active.node[k], pull, ahead)
    return power


@inlined
def _power_on_node(rail, state, active, node, pull, ahead):
    m, power = rail.inverse_mass[node], 0.0
    for i in range(3):
        kick = ahead * (pull[i] - m * state.resistance[node, i]) if m > 0.0 else 0.0
        power += active.drag[node, i] * (state.velocity[node, i] + kick)
    return power
