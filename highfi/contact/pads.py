"""Contact forces between the crowned, rigid pad faces and the deformed walls, from one potential.

A face is divided into cells. The wall w(X, Y) is seen along its nominal normal, the axis n of the
frame (``contact.wall``). A cell with its middle at x, in the plane at (X, Y), has

    p = s (x_n - w(X, Y)),      E = k A c p^2 / 2 for p > 0

with s = +1 or -1 along the outward normal of the face, the area A of the cell, and the share c of
it that is over the wall. Forces are minus the gradient of E: with respect to x on the payload, to
the nodes' u on the rail::

    on the payload   -k A c p s (n - dw/dX - dw/dY) - k A p^2 / 2 (dc/dX, dc/dY)
    on node a        +k A c p s N_a n

So contact stores energy exactly, also where a tilted face slides along its wall or over its end.
The force on the payload is along the normal of the deformed wall. The frame takes its small
components along the wall and the moment due to the distance of the cell from the wall, as it does
for the elastic force of the rails (``dynamics.step``). So momentum is exact as well. Friction acts
across that normal, at the sliding velocity of the half step, with opposite forces on both sides.

A face is skipped until it could reach the wall: its smallest gap divided by ``FASTEST_APPROACH``
gives the time. The actual speed is checked at every sample. Over a rail at rest
(``dynamics.resting``) a face is ``near`` once it cannot be skipped for a whole step. The rail is
stepped from then on, before a cell can press it or after a face has slid onto it.

A wall is a plate. A point whose penetration exceeds the thickness is behind the wall and has no
contact force. A face that comes over its wall may have a penetration of ``ROUNDED`` at most. A face
that comes deeper strikes an edge or the back of the wall (``lowfi.contact.wall_ends`` has the same
rule for rigid walls). Contact is not modelled there: the face has no contact force, and the run
ends.

Faces that can share a node form a group, for example all faces along one rail. Groups share
nothing, so each thread takes whole groups; the loads are added in the order of the groups.
"""

import numpy as np

from tipoff.highfi.contact.cells import (
    Touch,
    depth_of_part,
    face_of,
    nearest_wall,
    no_spot,
    place_of,
    press,
    probe,
    rate_damping,
    spot_under,
)
from tipoff.highfi.state.nodes import follow_frame
from tipoff.highfi.state.pose import triple
from tipoff.highfi.state.records import AWAY, CONTACT, FRICTION, OVER, UNKNOWN
from tipoff.highfi.state.threads import take
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.absent import rubs

# m/s across the rail: a face this far from every facet is skipped until it could arrive
FASTEST_APPROACH = 10.0
ROUNDED = 1e-6  # m; edges of pads and walls have at least this radius
# m on either side of a border: the zone in which a face comes over its wall, which deforms by less
_ENTRY = 1e-4
# m: a larger gap counts as this one, because the face may slide over another part of the wall
_FARTHEST = 1e-3
# m: rounding of a depth, which has magnitudes of less than 100 m, is smaller
_ROUNDING = 1e-12
# m/s along the wall: a face this far from the border is skipped until it could arrive
FASTEST_SLIDE = 1000.0


@inlined
def contact_forces(constants, state, active, pose, team):
    """Fill ``state.contact``, ``state.loads``, ``state.face_force``, its moment and ``active``; called by every
    thread of ``team``."""
    if constants.interface_stiffness > 0.0:
        group = take(team)
        while group < constants.surface.groups.first_face.size - 1:
            _forces_of_group(constants, state, active, pose, group)
            group = take(team)


@inlined
def _forces_of_group(constants, state, active, pose, group):
    rail, surface, groups = constants.rail, constants.surface, constants.surface.groups
    touch = Touch(
        inverse_mass=rail.inverse_mass,
        displacement=state.displacement,
        velocity=state.velocity,
        contact=state.contact,
        face_force=state.face_force,
        face_moment=state.face_moment,
        load=state.loads[group],
        group=group,
        surface=surface,
        faces=constants.faces,
        active=active,
        pose=pose,
        interface_stiffness=constants.interface_stiffness,
        dt=constants.dt,
        substeps=constants.substeps,
    )
    _clear(touch.load)
    first, last = groups.first_clamped[group], groups.first_clamped[group + 1]
    follow_frame(rail, state, constants.frame, groups.clamped, first, last)
    _forget(touch)
    for k in range(groups.first_face[group], groups.first_face[group + 1]):
        _forces_of_face(touch, constants.friction, groups.face[k])
    rate_damping(touch, constants.friction)


@inlined
def _clear(load):
    for i in range(3):
        load.normal_force[i] = load.friction_force[i] = 0.0
        load.moment[i] = load.moment_on_rail[i] = load.friction_moment[i] = 0.0
    load.stored = load.on_walls = load.damping_rate = 0.0
    load.pressed = load.rubbed = 0


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
    active.node_count[group] = 0


@inlined
def _forces_of_face(touch, friction, face):
    """Forces of one face, unless it is skipped."""
    active = touch.active
    for i in range(3):
        touch.face_force[face, i] = touch.face_moment[face, i] = 0.0
    if active.struck[face].depth > 0.0:
        active.struck[face].age += touch.dt
    elif active.wait[face] > 0:
        active.wait[face] -= 1
    elif touch.surface.search.wall[face] >= 0:
        here = face_of(touch, face)
        overlap = _overlap(touch, here)
        _check_wall(touch, here, overlap)
        if overlap < 0.0:
            active.wait[face] = int(-overlap / (FASTEST_SLIDE * touch.dt))
        elif active.struck[face].depth == 0.0:
            gap = _forces_of_cells(touch, friction, here)
            # The loop returns after whole steps only, so a near face must be found one step before.
            active.wait[face] = max(0, int(gap / (FASTEST_APPROACH * touch.dt)) - touch.substeps)
            if active.wait[face] == 0 and active.rests[touch.group]:
                active.near[touch.group] = True


@inlined
def _forces_of_cells(touch, friction, face):
    """Forces of all cells of a face; returns a lower bound (m) of their gaps to the wall, at most
    ``_FARTHEST``."""
    wall = nearest_wall(touch, face)
    across = face.sign * face.middle[face.axis] - wall + _deepest(touch, face, face.across, 1)
    deepest = across + _deepest(touch, face, face.along, 0)
    if deepest > -_ROUNDING and not touch.active.rests[touch.group]:
        spot = no_spot()
        for row in range(touch.surface.cells[face.number, 0]):
            if across + depth_of_part(touch, face, face.along, 0, row) > -_ROUNDING:
                spot = _forces_of_row(touch, friction, face, row, wall, spot)
    return min(max(0.0, -deepest), _FARTHEST)


@inlined
def _deepest(touch, face, direction, side):
    """Largest ``depth_of_part`` (m) along one side."""
    deepest = -np.inf
    for index in range(touch.surface.cells[face.number, side]):
        deepest = max(deepest, depth_of_part(touch, face, direction, side, index))
    return deepest


@inlined
def _forces_of_row(touch, friction, face, row, wall, spot):
    """Forces of a row of cells; ``wall`` (m) as ``nearest_wall``. Returns the last spot, from
    ``spot`` on."""
    for column in range(touch.surface.cells[face.number, 1]):
        place = place_of(touch, face, row, column)
        if face.sign * place[face.axis] - wall > 0.0:
            spot = spot_under(touch, face, place, spot)
            if spot.facet >= 0 and 0.0 < spot.penetration < touch.surface.thickness:
                press(touch, friction, face, place, spot)
    return spot


@inlined
def _overlap(touch, face):
    """Length (m) by which a face reaches over the border of its wall: the smaller one of those
    along and across the rail."""
    faces, border = touch.faces, touch.surface.border[face.number]
    length, width = faces.half_length[face.number], faces.half_width[face.number]
    x, y = face.middle[0], face.middle[1] if face.axis == 2 else face.middle[2]
    along = min(x + length - border[0], border[1] - x + length)
    return min(along, y + width - border[2], border[3] - y + width)


@inlined
def _check_wall(touch, face, overlap):
    """Update ``active.side``, and ``active.struck`` if a face strikes its wall from the side."""
    active, number = touch.active, face.number
    if overlap < -_ENTRY:
        active.side[number] = AWAY
    elif active.side[number] != OVER:
        inside, behind = probe(touch, face)
        if active.side[number] == AWAY and inside > ROUNDED:
            active.struck[number].depth, active.struck[number].x = inside, face.middle[0]
        elif behind >= touch.surface.thickness:
            active.side[number] = AWAY
        elif overlap > _ENTRY or active.side[number] == UNKNOWN:
            active.side[number] = OVER


@kernel
def collect_contact(rail, surface, state, active):
    """Sum up loads, move contact forces of moving nodes into the resistance and
    ``state.reaction``, and count the cells."""
    load = state.load[0]
    _clear(load)
    for group in range(surface.groups.first_face.size - 1):
        _add_load(load, state.loads[group])
        first = surface.groups.first_node[group]
        for k in range(first, first + active.node_count[group]):
            load.on_walls += _collect_node(rail, state, active.node[k])
    state.evaluated[CONTACT] += load.pressed
    state.evaluated[FRICTION] += load.rubbed


@inlined
def _add_load(total, part):
    for i in range(3):
        total.normal_force[i] += part.normal_force[i]
        total.friction_force[i] += part.friction_force[i]
        total.moment[i] += part.moment[i]
        total.moment_on_rail[i] += part.moment_on_rail[i]
        total.friction_moment[i] += part.friction_moment[i]
    total.stored += part.stored
    total.damping_rate = max(total.damping_rate, part.damping_rate)
    total.pressed += part.pressed
    total.rubbed += part.rubbed


@inlined
def _collect_node(rail, state, node):
    """Returns u f (J) of the resistance of contact at a node."""
    f, u = triple(state.contact[node]), triple(state.displacement[node])
    if rail.inverse_mass[node] > 0.0:
        x = triple(rail.points[node])
        moment = rotation.cross((x[0] + u[0], x[1] + u[1], x[2] + u[2]), f)
        for i in range(3):
            state.resistance[node, i] += f[i]
            state.reaction[i] -= f[i]
            state.reaction[3 + i] -= moment[i]
    for i in range(3):
        state.contact[node, i] = 0.0
    return rotation.dot(u, f)


@inlined
def friction_power(friction, constants, state, active, pose, acceleration, ahead):
    """Power (W) of the present friction at the velocities of ``pose`` and at those of the nodes
    after a kick of ``ahead`` (s), with the ``acceleration`` (m/s2) of the body force."""
    power, load, groups = 0.0, state.load[0], constants.surface.groups
    if rubs(friction):
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
