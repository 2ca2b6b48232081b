"""Contact of one crowned, rigid pad face with the Gauss points of one facet of a wall; see
``contact`` for the law.

Everything is in frame axes unless said otherwise. A facet has four corners or the six nodes of a
quadratic triangle; which of them is known when a run is compiled, so that loops over nodes have a
known length.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.state.records import (
    BORDER,
    DAMPING_RATIO,
    FRICTION_FORCE,
    FRICTION_MOMENT,
    GAINED,
    MOMENT,
    MOMENT_ON_RAIL,
    NODES,
    NORMAL_FORCE,
    STORED,
)
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.scenes.effects.friction import coefficient_over_speed

# of the half face: nearer its middle no point can have left or entered over the edge within a step
_BORDER = 0.95


class Touch(NamedTuple):
    """The part of Rail and State that contact reads and writes: the whole records would be costly
    to compile. ``load`` is that of the group of faces at hand."""

    points: np.ndarray
    inverse_mass: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    contact: np.ndarray
    load: np.ndarray
    face_force: np.ndarray


@inlined
def _size(control):
    """Nodes of a facet: a constant of the compiled code."""
    size = 4
    if control is not None:
        size = 6
    return size


@inlined
def _nodes(surface, control, facet):
    """Numbers of the nodes of a facet, the last two meaningless where it has only four.

    Unsigned, because an index that might be negative would need a test.
    """
    fifth, sixth = np.uint64(0), np.uint64(0)
    if control is not None:
        fifth, sixth = np.uint64(surface.facets[facet, 4]), np.uint64(surface.facets[facet, 5])
    return (
        np.uint64(surface.facets[facet, 0]),
        np.uint64(surface.facets[facet, 1]),
        np.uint64(surface.facets[facet, 2]),
        np.uint64(surface.facets[facet, 3]),
        fifth,
        sixth,
    )


@inlined
def _from_centre(touch, node, pose):
    """Deformed place (m) of a node from the payload's mass centre."""
    return (
        touch.points[node, 0] + touch.displacement[node, 0] - pose.centre[0],
        touch.points[node, 1] + touch.displacement[node, 1] - pose.centre[1],
        touch.points[node, 2] + touch.displacement[node, 2] - pose.centre[2],
    )


@inlined
def _height(touch, faces, face, row, node, pose):
    """Outward height (m) of a node over the uncrowned plane of the face; negative inside. ``row``
    of the pose's rotation."""
    place = rotation.dot(row, _from_centre(touch, node, pose))
    return faces.sign[face] * (place - faces.centre[face, faces.axis[face]])


@inlined
def lowest(touch, surface, control, faces, face, facet, pose):
    """Smallest outward height (m) of the facet's control points over the uncrowned plane of the
    face; negative inside."""
    axis, nodes = faces.axis[face], _nodes(surface, control, facet)
    # Only one row of the rotation is needed.
    row = (pose.turn[axis], pose.turn[3 + axis], pose.turn[6 + axis])
    least = np.inf
    if control is None:
        for node in range(4):
            least = min(least, _height(touch, faces, face, row, nodes[node], pose))
    if control is not None:
        heights = (
            _height(touch, faces, face, row, nodes[0], pose),
            _height(touch, faces, face, row, nodes[1], pose),
            _height(touch, faces, face, row, nodes[2], pose),
            _height(touch, faces, face, row, nodes[3], pose),
            _height(touch, faces, face, row, nodes[4], pose),
            _height(touch, faces, face, row, nodes[5], pose),
        )
        for point in range(6):
            height = 0.0
            for node in range(6):
                height += control[point, node] * heights[node]
            least = min(least, height)
    return least


@inlined
def _in_payload(touch, node, pose):
    return rotation.unrotate(pose.turn, _from_centre(touch, node, pose))


@inlined
def _places(touch, control, nodes, pose):
    """Places (m) of the nodes of a facet in payload axes, followed by zeros where it has only
    four."""
    fifth, sixth = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if control is not None:
        fifth, sixth = _in_payload(touch, nodes[4], pose), _in_payload(touch, nodes[5], pose)
    return (
        _in_payload(touch, nodes[0], pose),
        _in_payload(touch, nodes[1], pose),
        _in_payload(touch, nodes[2], pose),
        _in_payload(touch, nodes[3], pose),
        fifth,
        sixth,
    )


@inlined
def _velocity(touch, node):
    return (touch.velocity[node, 0], touch.velocity[node, 1], touch.velocity[node, 2])


@inlined
def _velocities(touch, control, nodes):
    """Velocities (m/s) of the nodes of a facet, followed by zeros where it has only four."""
    fifth, sixth = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if control is not None:
        fifth, sixth = _velocity(touch, nodes[4]), _velocity(touch, nodes[5])
    return (
        _velocity(touch, nodes[0]),
        _velocity(touch, nodes[1]),
        _velocity(touch, nodes[2]),
        _velocity(touch, nodes[3]),
        fifth,
        sixth,
    )


@inlined
def _blend(surface, q, values):
    """Value at Gauss point ``q`` of what the nodes of a facet have."""
    x, y, z = 0.0, 0.0, 0.0
    for node in range(_size(surface.control)):
        weight, value = surface.shape[q, node], values[node]
        x += weight * value[0]
        y += weight * value[1]
        z += weight * value[2]
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
def is_off(touch, surface, faces, face, facet, q, pose):
    """Whether a Gauss point lies outside the border of the face."""
    places = _places(touch, surface.control, _nodes(surface, surface.control, facet), pose)
    xi, eta, _ = _local(faces, face, _blend(surface, q, places))
    return abs(xi) > 1.0 or abs(eta) > 1.0


@inlined
def press(touch, surface, faces, face, facet, group, penalty, friction, active, pose, dt):
    """Forces between a face and all Gauss points of a facet."""
    nodes = _nodes(surface, surface.control, facet)
    places, velocities, pressed = (
        _places(touch, surface.control, nodes, pose),
        _velocities(touch, surface.control, nodes),
        False,
    )
    for q in range(surface.shape.shape[0]):
        y = _blend(surface, q, places)
        xi, eta, height = _local(faces, face, y)
        if height < 0.0 and abs(xi) <= 1.0 and abs(eta) <= 1.0:
            penetration = -height - faces.relief[face] * (xi * xi * xi * xi + eta * eta * eta * eta)
            if 0.0 < penetration < surface.thickness:
                pressed = True
                arm = rotation.rotate(pose.turn, y)
                slide = _sliding_velocity(pose, arm, _blend(surface, q, velocities))
                weight = penalty * surface.area[facet, q]
                energy = 0.5 * weight * penetration * penetration
                touch.load[STORED] += energy
                if max(abs(xi), abs(eta)) > _BORDER:
                    _mind_the_edge(
                        touch,
                        faces,
                        face,
                        facet,
                        q,
                        surface,
                        group,
                        active,
                        pose,
                        xi,
                        eta,
                        slide,
                        energy,
                        dt,
                    )
                g = _gradient(faces, face, pose, xi, eta)
                push = weight * penetration
                drag = _friction_on_payload(
                    friction, touch, surface, nodes, q, g, arm, push, slide, active
                )
                _apply_pair(
                    touch,
                    surface,
                    nodes,
                    q,
                    face,
                    pose,
                    arm,
                    (push * g[0], push * g[1], push * g[2]),
                    drag,
                )
    if pressed:
        _note_nodes(surface, nodes, group, active)


@kernel
def probe(touch, surface, faces, face, facet, pose):
    """Of the Gauss points of a facet that are under a face: largest penetration (m) inside the
    wall, and largest of all."""
    places, inside, behind = (
        _places(touch, surface.control, _nodes(surface, surface.control, facet), pose),
        0.0,
        0.0,
    )
    for q in range(surface.shape.shape[0]):
        xi, eta, height = _local(faces, face, _blend(surface, q, places))
        if abs(xi) <= 1.0 and abs(eta) <= 1.0:
            penetration = -height - faces.relief[face] * (xi * xi * xi * xi + eta * eta * eta * eta)
            behind = max(behind, penetration)
            if penetration < surface.thickness:
                inside = max(inside, penetration)
    return inside, behind


@inlined
def _gradient(faces, face, pose, xi, eta):
    """Outward gradient of the height over the crowned face."""
    slope_x = 4.0 * faces.relief[face] * xi * xi * xi / faces.half_length[face]
    slope_across = 4.0 * faces.relief[face] * eta * eta * eta / faces.half_width[face]
    if faces.axis[face] == 1:
        gradient = (slope_x, faces.sign[face], slope_across)
    else:
        gradient = (slope_x, slope_across, faces.sign[face])
    return rotation.rotate(pose.turn, gradient)


@inlined
def _sliding_velocity(pose, arm, rail):
    """Velocity (m/s) of the payload's material at ``arm`` from its mass centre relative to that of
    the ``rail``."""
    spin = rotation.cross(pose.rate, arm)
    return (
        pose.velocity[0] + spin[0] - rail[0],
        pose.velocity[1] + spin[1] - rail[1],
        pose.velocity[2] + spin[2] - rail[2],
    )


@inlined
def _mind_the_edge(
    touch, faces, face, facet, q, surface, group, active, pose, xi, eta, slide, energy, dt
):
    """Remember a loaded point near the border of its face, where it may leave, or may just have
    come over the edge."""
    if _came_over_the_edge(faces, face, xi, eta, rotation.unrotate(pose.turn, slide), dt):
        # The point was outside the face a step ago: it meets a pressed face at once, and its energy
        # was never worked in.
        touch.load[GAINED] += energy
    k = surface.groups.first_point[group] + active.count[group, BORDER]
    active.point[k, 0], active.point[k, 1] = facet, q
    active.face[k] = face
    active.energy[k] = energy
    active.count[group, BORDER] += 1


@inlined
def _came_over_the_edge(faces, face, xi, eta, slide, dt):
    """Whether the point lay outside the face one step ago; ``slide`` in payload axes, opposite to
    the point's own motion."""
    before_xi = xi + dt * slide[0] / faces.half_length[face]
    before_eta = eta + dt * slide[3 - faces.axis[face]] / faces.half_width[face]
    return abs(before_xi) > 1.0 or abs(before_eta) > 1.0


@inlined
def _note_nodes(surface, nodes, group, active):
    for corner in range(_size(surface.control)):
        node = nodes[corner]
        if not active.seen[node]:
            active.seen[node] = True
            active.node[surface.groups.first_node[group] + active.count[group, NODES]] = node
            active.count[group, NODES] += 1


@inlined
def _friction_on_payload(friction, touch, surface, nodes, q, g, arm, push, slide, active):
    """Friction force (N) on the payload; zero and not compiled when ``friction`` is None.

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
            node, weight = nodes[corner], surface.shape[q, corner]
            active.node_damping[node] += surface.spread[q, corner] * damping
            for i in range(3):
                active.drag[node, i] += weight * drag[i]
    return drag


@inlined
def _apply_pair(touch, surface, nodes, q, face, pose, arm, on_rail, drag):
    """One force on the rail and its opposite on the payload, both at ``arm`` from the payload's
    mass centre."""
    total = (drag[0] - on_rail[0], drag[1] - on_rail[1], drag[2] - on_rail[2])
    for corner in range(_size(surface.control)):
        node, weight = nodes[corner], surface.shape[q, corner]
        for i in range(3):
            touch.contact[node, i] += weight * total[i]
    moment = rotation.cross(arm, total)
    about_origin = rotation.cross(
        (arm[0] + pose.centre[0], arm[1] + pose.centre[1], arm[2] + pose.centre[2]), total
    )
    for i in range(3):
        touch.load[NORMAL_FORCE + i] -= on_rail[i]
        touch.load[MOMENT + i] += moment[i]
        touch.load[MOMENT_ON_RAIL + i] -= about_origin[i]
        touch.face_force[face, i] += total[i]


@kernel
def rate_damping(touch, surface, friction, group, active, dt):
    """Largest step * damping / mass of a node, for the stability check."""
    if friction is not None:
        first = surface.groups.first_node[group]
        for k in range(first, first + active.count[group, NODES]):
            node = active.node[k]
            touch.load[DAMPING_RATIO] = max(
                touch.load[DAMPING_RATIO], dt * active.node_damping[node] * touch.inverse_mass[node]
            )
