"""Contact forces between the crowned, rigid pad faces and the Gauss points of the rail walls.

For a point y in payload axes, with local face coordinates xi, eta in [-1, 1] and outward height h
over the flat face::

    p = -h - relief (xi^4 + eta^4),      potential k_p p^2 / 2 per area for p > 0

The force on the rail is minus the full gradient of that potential, with the small tangential part
of the crown's slope, so the contact stores energy exactly. The opposite force acts on the payload at
the same point. Friction uses the shared law with the sliding velocity of the half step. Only what
can touch is computed. A facet is skipped when its control points (``mesh.facets``) lie outside the
uncrowned face plane: no Gauss point in their hull can have crossed it. A face whose nearest control
point is a gap away is skipped until something that approaches at ``FASTEST_APPROACH`` could have
closed it. That speed is checked at every sample.

A wall is a plate: a point behind its surface by its thickness or more is behind the wall, without
contact force. A face that was over no wall, or behind it, may come over it with a penetration of
``ROUNDED`` at most. A face that comes deeper strikes an edge or the back of the wall
(``lowfi.contact.wall_ends`` has the same rule for rigid walls). No contact is modelled there: the
face has no contact force, and the run ends.

Faces that can share a node make a group, as those along one rail do. Groups have nothing in common,
so threads take them one by one; their loads are added in the order of the groups.
"""

import numpy as np

from tipoff.highfi.contact.facet import Touch, is_off, lowest, press, probe, rate_damping
from tipoff.highfi.state.nodes import follow_frame
from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import AWAY, OVER, TOTAL, UNKNOWN
from tipoff.highfi.state.threads import take
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel

# m/s across the rail: a face this far from every facet is skipped until it could arrive
FASTEST_APPROACH = 10.0
ROUNDED = 1e-6  # m: no edge of a pad or a wall is sharper
# m: over this length on either side a face comes over the first points of its wall, which deforms
# by less
_ENTRY = 1e-4
_MARGIN = 1e-3  # m along the rail by which the searched window is wider than the face


@inlined
def contact_forces(interface_stiffness, constants, state, active, pose, team):
    """Fill ``state.contact``, ``state.loads``, ``state.face_force`` and ``active``; every thread of
    ``team`` takes a part of it."""
    if interface_stiffness is not None:
        group = take(team)
        while group < constants.surface.groups.first_face.size - 1:
            _forces_of_group(constants, state, active, pose, group)
            group = take(team)


@inlined
def _forces_of_group(constants, state, active, pose, group):
    rail, surface, groups = constants.rail, constants.surface, constants.surface.groups
    touch = Touch(
        points=surface.places,
        inverse_mass=rail.inverse_mass,
        displacement=state.displacement,
        velocity=state.velocity,
        contact=state.contact,
        face_force=state.face_force,
        load=state.loads[group],
        group=group,
        surface=surface,
        faces=constants.faces,
        active=active,
        pose=pose,
        interface_stiffness=constants.interface_stiffness,
        dt=constants.dt,
    )
    _clear(touch.load)
    first, last = groups.first_clamped[group], groups.first_clamped[group + 1]
    follow_frame(rail, state, constants.frame, groups.clamped, first, last)
    _release_over_the_edge(touch)
    _forget(touch)
    for k in range(groups.first_face[group], groups.first_face[group + 1]):
        _forces_of_face(touch, constants.friction, groups.face[k])
    rate_damping(touch, constants.friction)


@inlined
def _clear(load):
    for i in range(3):
        load.normal_force[i] = load.friction_force[i] = 0.0
        load.moment[i] = load.moment_on_rail[i] = load.friction_moment[i] = 0.0
    load.stored = load.damping_ratio = load.gained = 0.0


@inlined
def _forget(touch):
    active, group = touch.active, touch.group
    first = touch.surface.groups.first_node[group]
    for k in range(first, first + active.node_count[group]):
        node = active.node[k]
        active.seen[node] = False
        active.node_damping[node] = 0.0
        for i in range(3):
            active.drag[node, i] = 0.0
    active.point_count[group] = 0
    active.node_count[group] = 0


@inlined
def _forces_of_face(touch, friction, face):
    """Forces of one face, if it can touch by now."""
    surface, faces, pose, active = touch.surface, touch.faces, touch.pose, touch.active
    touch.face_force[face, 0], touch.face_force[face, 1], touch.face_force[face, 2] = 0.0, 0.0, 0.0
    if active.struck[face].depth > 0.0:
        active.struck[face].steps += 1.0
    elif active.wait[face] > 0:
        active.wait[face] -= 1
    else:
        place = rotation.rotate(pose.turn, triple(faces.centre[face]))
        x = place[0] + pose.centre[0]
        half = faces.half_length[face] + _MARGIN
        first, last = surface.first[face], surface.first[face + 1]
        window = surface.start[first:last]
        low = first + np.searchsorted(window, x - half - surface.longest)
        high = first + np.searchsorted(window, x + half)
        gap = _MARGIN
        _check_wall(touch, face, low, high, x, _overlap(touch, face, place))
        for k in range(low, high):
            facet = surface.reach[k]
            height = lowest(touch, surface.control, face, facet)
            gap = min(gap, height)
            if height < 0.0 and active.struck[face].depth == 0.0:
                press(touch, friction, face, facet)
        active.wait[face] = max(0, int(gap / (FASTEST_APPROACH * touch.dt)) - 1)


@inlined
def _overlap(touch, face, place):
    """By how much (m) a face reaches over the border of its wall's points, along or across the
    rail, whichever is less."""
    faces, centre = touch.faces, touch.pose.centre
    axis, border = 3 - faces.axis[face], touch.surface.border[face]
    x, y = (
        place[0] + centre[0],
        place[1] + centre[1] if axis == 1 else place[2] + centre[2],
    )
    along = min(x + faces.half_length[face] - border[0], border[1] - x + faces.half_length[face])
    return min(
        along, y + faces.half_width[face] - border[2], border[3] - y + faces.half_width[face]
    )


@inlined
def _check_wall(touch, face, low, high, x, overlap):
    """Bring ``active.side`` up to date, and ``active.struck`` where a face with its middle at ``x``
    (m) comes into its wall from the side; it can touch facets ``low`` to ``high``."""
    surface, active = touch.surface, touch.active
    if overlap < -_ENTRY:
        active.side[face] = AWAY
    elif active.side[face] != OVER:
        inside, behind = 0.0, 0.0
        for k in range(low, high):
            found = probe(touch, face, surface.reach[k])
            inside, behind = max(inside, found[0]), max(behind, found[1])
        if active.side[face] == AWAY and inside > ROUNDED:
            active.struck[face].depth, active.struck[face].x = inside, x
        elif behind >= surface.thickness:
            active.side[face] = AWAY
        elif overlap > _ENTRY or active.side[face] == UNKNOWN:
            active.side[face] = OVER


@inlined
def _release_over_the_edge(touch):
    """Release the energy of points that carried load a step ago and are no longer under their
    face."""
    active, first = touch.active, touch.surface.groups.first_point[touch.group]
    for k in range(first, first + active.point_count[touch.group]):
        point = active.edge_point[k]
        if is_off(touch, point.face, point.facet, point.gauss_point):
            touch.load.gained -= point.energy


@kernel
def collect_contact(rail, surface, state, active):
    """Sum up loads, move contact forces of moving nodes into the resistance and ``state.reaction``,
    released energy into work."""
    load = state.load[0]
    _clear(load)
    for group in range(surface.groups.first_face.size - 1):
        _add_load(load, state.loads[group])
        first = surface.groups.first_node[group]
        for k in range(first, first + active.node_count[group]):
            _collect_node(rail, state, active.node[k])
    state.work[TOTAL].released -= load.gained


@inlined
def _add_load(total, part):
    for i in range(3):
        total.normal_force[i] += part.normal_force[i]
        total.friction_force[i] += part.friction_force[i]
        total.moment[i] += part.moment[i]
        total.moment_on_rail[i] += part.moment_on_rail[i]
        total.friction_moment[i] += part.friction_moment[i]
    total.stored += part.stored
    total.damping_ratio = max(total.damping_ratio, part.damping_ratio)
    total.gained += part.gained


@inlined
def _collect_node(rail, state, node):
    f = triple(state.contact[node])
    if rail.inverse_mass[node] > 0.0:
        x, u = triple(rail.points[node]), triple(state.displacement[node])
        moment = rotation.cross((x[0] + u[0], x[1] + u[1], x[2] + u[2]), f)
        for i in range(3):
            state.resistance[node, i] += f[i]
            state.reaction[i] -= f[i]
            state.reaction[3 + i] -= moment[i]
    for i in range(3):
        state.contact[node, i] = 0.0


@inlined
def friction_power(friction, constants, state, active, pose, acceleration, ahead):
    """Power (W) of the present friction at the velocities of ``pose`` and those of the nodes once
    kicked over ``ahead`` (s), with the ``acceleration`` (m/s2) of the body force."""
    power, load, groups = 0.0, state.load[0], constants.surface.groups
    if friction is not None:
        for i in range(3):
            power += (
                load.friction_force[i] * pose.velocity[i] + load.friction_moment[i] * pose.rate[i]
            )
        for group in range(groups.first_face.size - 1):
            first = groups.first_node[group]
            for k in range(first, first + active.node_count[group]):
                power -= _power_on_node(
                    constants.rail, state, active, active.node[k], acceleration, ahead
                )
    return power


@inlined
def _power_on_node(rail, state, active, node, acceleration, ahead):
    m, power = rail.inverse_mass[node], 0.0
    for i in range(3):
        kick = ahead * (acceleration[i] - m * state.resistance[node, i]) if m > 0.0 else 0.0
        power += active.drag[node, i] * (state.velocity[node, i] + kick)
    return power
