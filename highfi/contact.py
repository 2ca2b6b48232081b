"""Contact of the crowned, rigid pad faces with the Gauss points of the rail's surface facets.

For a point y in payload axes, with local face coordinates xi, eta in [-1, 1] and outward height h over the flat face::

    p = -h - relief (xi^4 + eta^4),      potential k_p p^2 / 2 per area for p > 0

The force on the rail is minus the full gradient of that potential (so it has the small tangential part that the crown's slope
calls for) and the contact stores energy exactly. The opposite force acts on the payload at the same point. Friction uses the
shared law with the half-step sliding velocity. Only what can touch is computed: a facet whose control points (``facets``; its four
corners, or those of a curved triangle) lie outside the uncrowned face plane is passed over, since no Gauss point in their hull can
have crossed it, and a face whose nearest control point is a gap away is not looked at until something approaching at
``FASTEST_APPROACH`` could have closed it. That speed is checked at every sample.
"""

from typing import NamedTuple

import numpy as np

from highfi.records import (BORDER, DAMPING_RATIO, FRICTION_FORCE, FRICTION_MOMENT, MOMENT, MOMENT_ON_RAIL, NODES, NORMAL_FORCE,
                            RELEASED, STORED)
from scenes import rotation
from scenes.effects.friction import coefficient_over_speed
from scenes.jit import inlined, kernel

FASTEST_APPROACH = 10.0  # m/s across the rail: a face this far from every facet is not looked at before it could arrive
_MARGIN = 1e-3  # m along the rail by which the searched window is wider than the face
_BORDER = 0.95  # of the half face: nearer its middle no point can have left or entered over the edge within a step


class Touch(NamedTuple):
    """The part of Rail and State that contact reads and writes: the whole records would be costly to compile."""

    points: np.ndarray
    inverse_mass: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    resistance: np.ndarray
    contact: np.ndarray
    load: np.ndarray
    work: np.ndarray
    face_force: np.ndarray
    reaction: np.ndarray


@kernel
def touched(rail, state):
    """What contact needs of a rail and its state."""
    return Touch(rail.points, rail.inverse_mass, state.displacement, state.velocity, state.resistance, state.contact, state.load,
                 state.work, state.face_force, state.reaction)


@kernel
def contact_forces(rail, surface, faces, penalty, friction, state, active, pose, dt):
    """Fill ``state.contact``, ``state.load``, ``state.face_force`` and ``active``; released energy goes to work."""
    state.load[:] = 0.0
    state.face_force[:] = 0.0
    if penalty is not None:
        touch = touched(rail, state)
        _release_over_the_edge(touch, surface, faces, active, pose)
        _forget(active)
        _all_faces(touch, surface, faces, penalty, friction, active, pose, dt)
        _rate_damping(touch, friction, active, dt)


@kernel
def _forget(active):
    for k in range(active.count[NODES]):
        node = active.node[k]
        active.seen[node] = False
        active.node_damping[node] = 0.0
        for i in range(3):
            active.drag[node, i] = 0.0
    active.count[BORDER] = 0
    active.count[NODES] = 0


@inlined
def _all_faces(touch, surface, faces, penalty, friction, active, pose, dt):
    for face in range(faces.axis.size):
        if active.wait[face] > 0:
            active.wait[face] -= 1
            continue
        place = rotation.rotate(pose.turn, (faces.centre[face, 0], faces.centre[face, 1], faces.centre[face, 2]))
        x = place[0] + pose.centre[0]
        half = faces.half_length[face] + _MARGIN
        first, last = surface.first[face], surface.first[face + 1]
        window = surface.start[first:last]
        low = first + np.searchsorted(window, x - half - surface.longest)
        high = first + np.searchsorted(window, x + half)
        gap = _MARGIN
        for k in range(low, high):
            facet = surface.reach[k]
            height = _lowest(touch, surface, surface.control, faces, face, facet, pose)
            gap = min(gap, height)
            if height < 0.0:
                _facet_points(touch, surface, faces, face, facet, penalty, friction, active, pose, dt)
        active.wait[face] = max(0, int(gap / (FASTEST_APPROACH * dt)) - 1)


@inlined
def _from_centre(touch, node, pose):
    """Deformed place (m) of a node from the payload's mass centre, in frame axes."""
    return (touch.points[node, 0] + touch.displacement[node, 0] - pose.centre[0],
            touch.points[node, 1] + touch.displacement[node, 1] - pose.centre[1],
            touch.points[node, 2] + touch.displacement[node, 2] - pose.centre[2])


@inlined
def _size(control):
    """Nodes of a facet: a constant of the compiled code, so that loops over them have a known length."""
    size = 4
    if control is not None:
        size = 6
    return size


@inlined
def _height(touch, surface, faces, face, row, facet, node, pose):
    """Outward height (m) of a facet's node over the uncrowned plane of the face; ``row`` of the pose's rotation."""
    place = rotation.dot(row, _from_centre(touch, surface.facets[facet, node], pose))
    return faces.sign[face] * (place - faces.centre[face, faces.axis[face]])


@inlined
def _lowest(touch, surface, control, faces, face, facet, pose):
    """Smallest outward height (m) of the facet's control points over the uncrowned plane of the face; negative inside."""
    axis = faces.axis[face]
    # Only one row of the rotation is needed.
    row = (pose.turn[axis], pose.turn[3 + axis], pose.turn[6 + axis])
    lowest = np.inf
    if control is None:
        for node in range(4):
            lowest = min(lowest, _height(touch, surface, faces, face, row, facet, node, pose))
    if control is not None:
        heights = (_height(touch, surface, faces, face, row, facet, 0, pose),
                   _height(touch, surface, faces, face, row, facet, 1, pose),
                   _height(touch, surface, faces, face, row, facet, 2, pose),
                   _height(touch, surface, faces, face, row, facet, 3, pose),
                   _height(touch, surface, faces, face, row, facet, 4, pose),
                   _height(touch, surface, faces, face, row, facet, 5, pose))
        for point in range(6):
            height = 0.0
            for node in range(6):
                height += control[point, node] * heights[node]
            lowest = min(lowest, height)
    return lowest


@inlined
def _in_payload(touch, surface, facet, node, pose):
    return rotation.unrotate(pose.turn, _from_centre(touch, surface.facets[facet, node], pose))


@inlined
def _places(touch, surface, control, facet, pose):
    """Places (m) of the nodes of a facet in payload axes, followed by zeros where it has only four."""
    fifth, sixth = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if control is not None:
        fifth, sixth = _in_payload(touch, surface, facet, 4, pose), _in_payload(touch, surface, facet, 5, pose)
    return (_in_payload(touch, surface, facet, 0, pose), _in_payload(touch, surface, facet, 1, pose),
            _in_payload(touch, surface, facet, 2, pose), _in_payload(touch, surface, facet, 3, pose), fifth, sixth)


@inlined
def _blend(surface, q, places):
    """Value at Gauss point ``q`` of what the nodes of a facet have."""
    x, y, z = 0.0, 0.0, 0.0
    for node in range(_size(surface.control)):
        weight, place = surface.shape[q, node], places[node]
        x += weight * place[0]
        y += weight * place[1]
        z += weight * place[2]
    return x, y, z


@inlined
def _local(faces, face, y):
    """Face coordinates (xi, eta) and outward height (m) of a point in payload axes."""
    axis = faces.axis[face]
    across = 3 - axis
    xi = (y[0] - faces.centre[face, 0]) / faces.half_length[face]
    eta = (y[across] - faces.centre[face, across]) / faces.half_width[face]
    return xi, eta, faces.sign[face] * (y[axis] - faces.centre[face, axis])


@inlined
def _facet_points(touch, surface, faces, face, facet, penalty, friction, active, pose, dt):
    places = _places(touch, surface, surface.control, facet, pose)
    for q in range(surface.shape.shape[0]):
        y = _blend(surface, q, places)
        xi, eta, height = _local(faces, face, y)
        if height < 0.0 and abs(xi) <= 1.0 and abs(eta) <= 1.0:
            penetration = -height - faces.relief[face] * (xi * xi * xi * xi + eta * eta * eta * eta)
            if penetration > 0.0:
                _press(touch, surface, faces, face, facet, q, penalty, friction, active, pose, y, xi, eta, penetration, dt)


@inlined
def _press(touch, surface, faces, face, facet, q, penalty, friction, active, pose, y, xi, eta, penetration, dt):
    axis = faces.axis[face]
    weight = penalty * surface.area[facet, q]
    slope_x = 4.0 * faces.relief[face] * xi * xi * xi / faces.half_length[face]
    slope_across = 4.0 * faces.relief[face] * eta * eta * eta / faces.half_width[face]
    if axis == 1:
        gradient = (slope_x, faces.sign[face], slope_across)
    else:
        gradient = (slope_x, slope_across, faces.sign[face])
    push = weight * penetration
    g, arm = rotation.rotate(pose.turn, gradient), rotation.rotate(pose.turn, y)
    slide = _sliding_velocity(touch, surface, facet, q, arm, pose)
    energy = 0.5 * weight * penetration * penetration
    touch.load[STORED] += energy
    if max(abs(xi), abs(eta)) > _BORDER:
        if _came_over_the_edge(faces, face, xi, eta, rotation.unrotate(pose.turn, slide), dt):
            # The point was outside the face a step ago: it meets a pressed face at once, and its energy was never worked in.
            touch.work[RELEASED] -= energy
        _remember(active, facet, q, face, energy)
    _note_nodes(surface, facet, active)
    drag = _friction_on_payload(friction, touch, surface, facet, q, g, arm, push, slide, active)
    _apply_pair(touch, surface, facet, q, face, pose, arm, (push * g[0], push * g[1], push * g[2]), drag)


@inlined
def _sliding_velocity(touch, surface, facet, q, arm, pose):
    """Velocity (m/s) of the payload's material at ``arm`` from its mass centre relative to the rail's, in frame axes."""
    spin = rotation.cross(pose.rate, arm)
    a, b, c = pose.velocity[0] + spin[0], pose.velocity[1] + spin[1], pose.velocity[2] + spin[2]
    for corner in range(_size(surface.control)):
        node, weight = surface.facets[facet, corner], surface.shape[q, corner]
        a -= weight * touch.velocity[node, 0]
        b -= weight * touch.velocity[node, 1]
        c -= weight * touch.velocity[node, 2]
    return (a, b, c)


@inlined
def _remember(active, facet, q, face, energy):
    k = active.count[BORDER]
    active.point[k, 0], active.point[k, 1] = facet, q
    active.face[k] = face
    active.energy[k] = energy
    active.count[BORDER] = k + 1


@inlined
def _note_nodes(surface, facet, active):
    for corner in range(_size(surface.control)):
        node = surface.facets[facet, corner]
        if not active.seen[node]:
            active.seen[node] = True
            active.node[active.count[NODES]] = node
            active.count[NODES] += 1


@inlined
def _friction_on_payload(friction, touch, surface, facet, q, g, arm, push, slide, active):
    """Friction force (N) on the payload in frame axes; zero and not compiled when ``friction`` is None.

    Also sums its moment and, at each node, its share and the damping (N s/m) it brings.
    """
    drag = (0.0, 0.0, 0.0)
    if friction is not None:
        size = np.sqrt(rotation.dot(g, g))
        along = rotation.dot(slide, g) / (size * size)
        t = (slide[0] - along * g[0], slide[1] - along * g[1], slide[2] - along * g[2])
        damping = push * size * coefficient_over_speed(friction, np.sqrt(rotation.dot(t, t)))
        drag = (-damping * t[0], -damping * t[1], -damping * t[2])
        moment = rotation.cross(arm, drag)
        for i in range(3):
            touch.load[FRICTION_FORCE + i] += drag[i]
            touch.load[FRICTION_MOMENT + i] += moment[i]
        for corner in range(_size(surface.control)):
            node, weight = surface.facets[facet, corner], surface.shape[q, corner]
            active.node_damping[node] += surface.spread[q, corner] * damping
            for i in range(3):
                active.drag[node, i] += weight * drag[i]
    return drag


@kernel
def _rate_damping(touch, friction, active, dt):
    """Largest step * damping / mass of a node, for the stability check."""
    if friction is not None:
        for k in range(active.count[NODES]):
            node = active.node[k]
            touch.load[DAMPING_RATIO] = max(touch.load[DAMPING_RATIO], dt * active.node_damping[node] * touch.inverse_mass[node])


@inlined
def _apply_pair(touch, surface, facet, q, face, pose, arm, on_rail, drag):
    """One force on the rail and its opposite on the payload, both at ``arm`` from the payload's mass centre."""
    total = (drag[0] - on_rail[0], drag[1] - on_rail[1], drag[2] - on_rail[2])
    for corner in range(_size(surface.control)):
        node, weight = surface.facets[facet, corner], surface.shape[q, corner]
        for i in range(3):
            touch.contact[node, i] += weight * total[i]
    moment = rotation.cross(arm, total)
    about_origin = rotation.cross((arm[0] + pose.centre[0], arm[1] + pose.centre[1], arm[2] + pose.centre[2]), total)
    for i in range(3):
        touch.load[NORMAL_FORCE + i] -= on_rail[i]
        touch.load[MOMENT + i] += moment[i]
        touch.load[MOMENT_ON_RAIL + i] -= about_origin[i]
        touch.face_force[face, i] += total[i]


@inlined
def _came_over_the_edge(faces, face, xi, eta, slide, dt):
    """Whether the point lay outside the face one step ago; ``slide`` in payload axes, opposite to the point's own motion."""
    before_xi = xi + dt * slide[0] / faces.half_length[face]
    before_eta = eta + dt * slide[3 - faces.axis[face]] / faces.half_width[face]
    return abs(before_xi) > 1.0 or abs(before_eta) > 1.0


@kernel
def _release_over_the_edge(touch, surface, faces, active, pose):
    """Energy of points that carried load a step ago and are no longer under their face goes to ``released``."""
    for k in range(active.count[BORDER]):
        facet = active.point[k, 0]
        places = _places(touch, surface, surface.control, facet, pose)
        xi, eta, _ = _local(faces, active.face[k], _blend(surface, active.point[k, 1], places))
        if abs(xi) > 1.0 or abs(eta) > 1.0:
            touch.work[RELEASED] += active.energy[k]


@kernel
def collect_contact(touch, active):
    """Move contact forces of nodes into their resistance, and add those on moving nodes to ``touch.reaction``."""
    for k in range(active.count[NODES]):
        node = active.node[k]
        f = (touch.contact[node, 0], touch.contact[node, 1], touch.contact[node, 2])
        if touch.inverse_mass[node] > 0.0:
            moment = rotation.cross((touch.points[node, 0] + touch.displacement[node, 0],
                                     touch.points[node, 1] + touch.displacement[node, 1],
                                     touch.points[node, 2] + touch.displacement[node, 2]), f)
            for i in range(3):
                touch.resistance[node, i] += f[i]
                touch.reaction[i] -= f[i]
                touch.reaction[3 + i] -= moment[i]
        for i in range(3):
            touch.contact[node, i] = 0.0


@kernel
def friction_power(touch, active, pose, friction, pull, ahead):
    """Power (W) of the present friction forces at the velocities of ``pose`` and those of the nodes once kicked over ``ahead`` (s)."""
    power = 0.0
    if friction is not None:
        for i in range(3):
            power += touch.load[FRICTION_FORCE + i] * pose.velocity[i] + touch.load[FRICTION_MOMENT + i] * pose.rate[i]
        for k in range(active.count[NODES]):
            node = active.node[k]
            m = touch.inverse_mass[node]
            for i in range(3):
                kick = ahead * (pull[i] - m * touch.resistance[node, i]) if m > 0.0 else 0.0
                power -= active.drag[node, i] * (touch.velocity[node, i] + kick)
    return power
