"""Contact force between one crowned, rigid pad face and the Gauss points of one facet of a wall;
see ``pads`` for the law.

Everything is in frame axes unless stated otherwise. A facet has four corners or the six nodes of a
quadratic triangle. Each run is compiled for one of the two, so that loops over nodes have a constant
length.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.state.pose import Pose
from tipoff.highfi.state.records import Active, Surface
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.model import Faces
from tipoff.scenes.effects.friction import coefficient_over_speed

# of the half face: nearer its middle no point can have left or entered over the edge within a step
_BORDER = 0.95


class Touch(NamedTuple):
    """What contact of one group of faces reads and writes: the whole records would be costly to
    compile."""

    points: np.ndarray  # (n,3) m, Surface.places
    inverse_mass: np.ndarray  # (n,) 1/kg
    displacement: np.ndarray  # (n,3) m
    velocity: np.ndarray  # (n,3) m/s
    contact: np.ndarray  # (n,3) N
    face_force: np.ndarray  # (f,3) N
    load: np.void  # LOAD of the group
    group: int
    surface: Surface
    faces: Faces
    active: Active
    pose: Pose
    interface_stiffness: float  # N/m3
    dt: float  # s


class _Point(NamedTuple):
    """A Gauss point under a face."""

    face: int
    facet: int
    q: int  # its number in the facet
    xi: float  # its place on the face, from -1 to 1 along X
    eta: float  # and across


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
def _from_centre(touch, node):
    """Deformed place (m) of a node from the payload's mass centre."""
    centre = touch.pose.centre
    return (
        touch.points[node, 0] + touch.displacement[node, 0] - centre[0],
        touch.points[node, 1] + touch.displacement[node, 1] - centre[1],
        touch.points[node, 2] + touch.displacement[node, 2] - centre[2],
    )


@inlined
def _height(touch, face, row, node):
    """Outward height (m) of a node over the uncrowned plane of the face; negative inside. ``row``
    of the pose's rotation."""
    faces = touch.faces
    place = rotation.dot(row, _from_centre(touch, node))
    return faces.sign[face] * (place - faces.centre[face, faces.axis[face]])


@inlined
def lowest(touch, control, face, facet):
    """Smallest outward height (m) of the facet's control points over the uncrowned plane of the
    face; negative inside."""
    axis, nodes, turn = (
        touch.faces.axis[face],
        _nodes(touch.surface, control, facet),
        touch.pose.turn,
    )
    # Only one row of the rotation is needed.
    row = (turn[axis], turn[3 + axis], turn[6 + axis])
    least = np.inf
    if control is None:
        for node in range(4):
            least = min(least, _height(touch, face, row, nodes[node]))
    if control is not None:
        heights = (
            _height(touch, face, row, nodes[0]),
            _height(touch, face, row, nodes[1]),
            _height(touch, face, row, nodes[2]),
            _height(touch, face, row, nodes[3]),
            _height(touch, face, row, nodes[4]),
            _height(touch, face, row, nodes[5]),
        )
        for point in range(6):
            height = 0.0
            for node in range(6):
                height += control[point, node] * heights[node]
            least = min(least, height)
    return least


@inlined
def _in_payload(touch, node):
    return rotation.unrotate(touch.pose.turn, _from_centre(touch, node))


@inlined
def _places(touch, control, nodes):
    """Places (m) of the nodes of a facet in payload axes, followed by zeros where it has only
    four."""
    fifth, sixth = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if control is not None:
        fifth, sixth = _in_payload(touch, nodes[4]), _in_payload(touch, nodes[5])
    return (
        _in_payload(touch, nodes[0]),
        _in_payload(touch, nodes[1]),
        _in_payload(touch, nodes[2]),
        _in_payload(touch, nodes[3]),
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
def is_off(touch, face, facet, q):
    """Whether a Gauss point lies outside the border of the face."""
    surface = touch.surface
    places = _places(touch, surface.control, _nodes(surface, surface.control, facet))
    xi, eta, _ = _local(touch.faces, face, _blend(surface, q, places))
    return abs(xi) > 1.0 or abs(eta) > 1.0


@inlined
def _penetration(faces, face, xi, eta, height):
    """Penetration (m) of a point into the crowned face."""
    return -height - faces.relief[face] * (xi * xi * xi * xi + eta * eta * eta * eta)


@inlined
def press(touch, friction, face, facet):
    """Forces between a face and all Gauss points of a facet."""
    surface, faces, pose = touch.surface, touch.faces, touch.pose
    nodes = _nodes(surface, surface.control, facet)
    places, velocities, pressed = (
        _places(touch, surface.control, nodes),
        _velocities(touch, surface.control, nodes),
        False,
    )
    for q in range(surface.shape.shape[0]):
        y = _blend(surface, q, places)
        xi, eta, height = _local(faces, face, y)
        if height < 0.0 and abs(xi) <= 1.0 and abs(eta) <= 1.0:
            penetration = _penetration(faces, face, xi, eta, height)
            if 0.0 < penetration < surface.thickness:
                pressed = True
                point = _Point(face=face, facet=facet, q=q, xi=xi, eta=eta)
                arm = rotation.rotate(pose.turn, y)
                slide = _sliding_velocity(pose, arm, _blend(surface, q, velocities))
                weight = touch.interface_stiffness * surface.area[facet, q]
                energy = 0.5 * weight * penetration * penetration
                touch.load.stored += energy
                if max(abs(xi), abs(eta)) > _BORDER:
                    _note_edge_point(touch, point, slide, energy)
                g = _gradient(touch, point)
                push = weight * penetration
                drag = _friction_on_payload(friction, touch, point, nodes, g, arm, push, slide)
                on_rail = (push * g[0], push * g[1], push * g[2])
                _apply_pair(touch, point, nodes, arm, on_rail, drag)
    if pressed:
        _note_nodes(touch, nodes)


@kernel
def probe(touch, face, facet):
    """Of the Gauss points of a facet that are under a face: largest penetration (m) inside the
    wall, and largest of all."""
    surface = touch.surface
    places, inside, behind = (
        _places(touch, surface.control, _nodes(surface, surface.control, facet)),
        0.0,
        0.0,
    )
    for q in range(surface.shape.shape[0]):
        xi, eta, height = _local(touch.faces, face, _blend(surface, q, places))
        if abs(xi) <= 1.0 and abs(eta) <= 1.0:
            penetration = _penetration(touch.faces, face, xi, eta, height)
            behind = max(behind, penetration)
            if penetration < surface.thickness:
                inside = max(inside, penetration)
    return inside, behind


@inlined
def _gradient(touch, point):
    """Outward gradient of the height over the crowned face."""
    faces, face, xi, eta = touch.faces, point.face, point.xi, point.eta
    slope_x = 4.0 * faces.relief[face] * xi * xi * xi / faces.half_length[face]
    slope_across = 4.0 * faces.relief[face] * eta * eta * eta / faces.half_width[face]
    if faces.axis[face] == 1:
        gradient = (slope_x, faces.sign[face], slope_across)
    else:
        gradient = (slope_x, slope_across, faces.sign[face])
    return rotation.rotate(touch.pose.turn, gradient)


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
def _note_edge_point(touch, point, slide, energy):
    """Store a loaded point near the edge of its face: it may leave, or may just have come over the
    edge."""
    active, group = touch.active, touch.group
    if _came_over_the_edge(touch, point, rotation.unrotate(touch.pose.turn, slide)):
        # The point was outside the face a step ago: it meets a pressed face at once, and its energy
        # was never worked in.
        touch.load.gained += energy
    k = touch.surface.groups.first_point[group] + active.point_count[group]
    noted = active.edge_point[k]
    noted.face, noted.facet, noted.gauss_point = point.face, point.facet, point.q
    noted.energy = energy
    active.point_count[group] += 1


@inlined
def _came_over_the_edge(touch, point, slide):
    """Whether the point lay outside the face one step ago; ``slide`` in payload axes, opposite to
    the point's own motion."""
    faces, face, dt = touch.faces, point.face, touch.dt
    before_xi = point.xi + dt * slide[0] / faces.half_length[face]
    before_eta = point.eta + dt * slide[3 - faces.axis[face]] / faces.half_width[face]
    return abs(before_xi) > 1.0 or abs(before_eta) > 1.0


@inlined
def _note_nodes(touch, nodes):
    surface, active, group = touch.surface, touch.active, touch.group
    for corner in range(_size(surface.control)):
        node = nodes[corner]
        if not active.seen[node]:
            active.seen[node] = True
            active.node[surface.groups.first_node[group] + active.node_count[group]] = node
            active.node_count[group] += 1


@inlined
def _friction_on_payload(friction, touch, point, nodes, g, arm, push, slide):
    """Friction force (N) on the payload; zero and not compiled when ``friction`` is None.

    Also sums its moment and, at each node, its share and the damping (N s/m) it brings. ``g``:
    gradient of the height; ``push`` (N): normal force over its length.
    """
    drag = (0.0, 0.0, 0.0)
    if friction is not None:
        surface, active = touch.surface, touch.active
        size = np.sqrt(rotation.dot(g, g))
        along = rotation.dot(slide, g) / (size * size)
        t = (slide[0] - along * g[0], slide[1] - along * g[1], slide[2] - along * g[2])
        damping = push * size * coefficient_over_speed(friction, np.sqrt(rotation.dot(t, t)))
        drag = (-damping * t[0], -damping * t[1], -damping * t[2])
        moment = rotation.cross(arm, drag)
        for i in range(3):
            touch.load.friction_force[i] += drag[i]
            touch.load.friction_moment[i] += moment[i]
        for corner in range(_size(surface.control)):
            node, weight = nodes[corner], surface.shape[point.q, corner]
            active.node_damping[node] += surface.spread[point.q, corner] * damping
            for i in range(3):
                active.drag[node, i] += weight * drag[i]
    return drag


@inlined
def _apply_pair(touch, point, nodes, arm, on_rail, drag):
    """One force on the rail and its opposite on the payload, both at ``arm`` from the payload's
    mass centre."""
    surface, centre, load = touch.surface, touch.pose.centre, touch.load
    total = (drag[0] - on_rail[0], drag[1] - on_rail[1], drag[2] - on_rail[2])
    for corner in range(_size(surface.control)):
        node, weight = nodes[corner], surface.shape[point.q, corner]
        for i in range(3):
            touch.contact[node, i] += weight * total[i]
    moment = rotation.cross(arm, total)
    about_origin = rotation.cross(
        (arm[0] + centre[0], arm[1] + centre[1], arm[2] + centre[2]), total
    )
    for i in range(3):
        load.normal_force[i] -= on_rail[i]
        load.moment[i] += moment[i]
        load.moment_on_rail[i] -= about_origin[i]
        touch.face_force[point.face, i] += total[i]


@inlined
def rate_damping(touch, friction):
    """Largest step * damping / mass of a node, for the stability check."""
    if friction is not None:
        active, load = touch.active, touch.load
        first = touch.surface.groups.first_node[touch.group]
        for k in range(first, first + active.node_count[touch.group]):
            node = active.node[k]
            load.damping_ratio = max(
                load.damping_ratio, touch.dt * active.node_damping[node] * touch.inverse_mass[node]
            )
