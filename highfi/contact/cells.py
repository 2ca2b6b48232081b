"""Contact force between a crowned, rigid pad face and the deformed wall, cell by cell; see ``pads``
for the law. Everything is in frame axes unless stated otherwise."""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.contact import wall
from tipoff.highfi.state.pose import Pose, triple
from tipoff.highfi.state.records import Active, Surface
from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.mechanics.absent import rubs
from tipoff.mechanics.laws.friction import coefficient_over_speed
from tipoff.mechanics.model import Faces


class Touch(NamedTuple):
    """Data that contact of one group of faces reads and writes. The whole records would take longer
    to compile."""

    inverse_mass: np.ndarray  # (n,) 1/kg
    displacement: np.ndarray  # (n,3) m
    velocity: np.ndarray  # (n,3) m/s
    contact: np.ndarray  # (n,3) N
    face_force: np.ndarray  # (f,3) N
    face_moment: np.ndarray  # (f,3) N m, about the payload's mass centre
    load: np.void  # LOAD of the group
    group: int
    surface: Surface
    faces: Faces
    active: Active
    pose: Pose
    interface_stiffness: float  # N/m3
    dt: float  # s
    substeps: int  # in a step


class Face(NamedTuple):
    """A pad face in its present pose. The place of (xi, eta, depth) is middle + xi along + eta across
    + depth inward."""

    number: int
    axis: int  # of the nominal normal of its wall
    sign: float  # of the outward normal of the face along that axis
    wall: int  # number of its wall
    middle: tuple  # (3,) m, of the uncrowned face
    along: tuple  # (3,) m, half of its length
    across: tuple  # (3,) m, half of its width
    inward: tuple  # (3,) unit vector
    area: float  # m2, of a cell
    size: tuple  # (2,) m, of a cell along X and across


class Spot(NamedTuple):
    """The wall under the middle of a cell."""

    facet: int  # -1 where there is no wall
    height: tuple  # (6,) m, of the nodes of the facet, see ``wall.heights``
    r: float  # place on the facet
    s: float
    penetration: float  # m, negative above the wall
    share: float  # of the cell that is over the wall
    by_x: float  # 1/m, slopes of the share along X and across
    by_y: float


@inlined
def face_of(touch, face):
    """The face in its present pose."""
    faces, turn, cells = touch.faces, touch.pose.turn, touch.surface.cells
    axis, sign = faces.axis[face], faces.sign[face]
    wide = 3 - axis
    length, width = faces.half_length[face], faces.half_width[face]
    arm = rotation.rotate(turn, triple(faces.centre[face]))
    centre = touch.pose.centre
    return Face(
        number=face,
        axis=axis,
        sign=sign,
        wall=touch.surface.search.wall[face],
        middle=(arm[0] + centre[0], arm[1] + centre[1], arm[2] + centre[2]),
        along=(length * turn[0], length * turn[3], length * turn[6]),
        across=(width * turn[wide], width * turn[3 + wide], width * turn[6 + wide]),
        inward=(-sign * turn[axis], -sign * turn[3 + axis], -sign * turn[6 + axis]),
        area=4.0 * length * width / (cells[face, 0] * cells[face, 1]),
        size=(2.0 * length / cells[face, 0], 2.0 * width / cells[face, 1]),
    )


@inlined
def fourth_power(index, count):
    """Middle of a cell in xi from -1 to 1, and the mean of xi^4 over the cell."""
    half = 1.0 / count
    xi = (2 * index + 1) * half - 1.0
    square, wide = xi * xi, half * half
    return xi, square * square + 2.0 * square * wide + 0.2 * wide * wide


@inlined
def place_of(touch, face, row, column):
    """Place (m) of the middle of a cell on the crowned face."""
    cells = touch.surface.cells
    xi, crown_x = fourth_power(row, cells[face.number, 0])
    eta, crown_y = fourth_power(column, cells[face.number, 1])
    depth = touch.faces.relief[face.number] * (crown_x + crown_y)
    middle, along, across, inward = face.middle, face.along, face.across, face.inward
    return (
        middle[0] + xi * along[0] + eta * across[0] + depth * inward[0],
        middle[1] + xi * along[1] + eta * across[1] + depth * inward[1],
        middle[2] + xi * along[2] + eta * across[2] + depth * inward[2],
    )


@inlined
def depth_of_part(touch, face, direction, side, index):
    """Part (m) of the depth of cells along the nominal normal that depends on their ``index`` along
    one ``side`` (0 ``face.along``, 1 ``face.across``, the ``direction``). Both parts and that of
    ``face.middle`` are the depth but for rounding."""
    place, crown = fourth_power(index, touch.surface.cells[face.number, side])
    relief, axis = touch.faces.relief[face.number], face.axis
    return face.sign * (place * direction[axis] + relief * crown * face.inward[axis])


@inlined
def no_spot():
    """No wall."""
    height = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Spot(
        facet=-1, height=height, r=0.0, s=0.0, penetration=-np.inf, share=0.0, by_x=0.0, by_y=0.0
    )


@inlined
def spot_under(touch, face, place, last):
    """The wall under a place (m) of the face, searched first on the facet of the ``last`` spot."""
    surface = touch.surface
    level, y = (place[1], place[2]) if face.axis == 1 else (place[2], place[1])
    facet, height, r, s = last.facet, last.height, 0.0, 0.0
    share, by_x, by_y, outside = 1.0, 0.0, 0.0, np.inf
    if facet >= 0 and not surface.by_border[facet]:
        r, s, outside = wall.local(surface, facet, place[0], y)
    if outside > wall.INSIDE:
        facet = -1
        cell_bin = wall.bin_under(surface.search, face.wall, place[0], y)
        if cell_bin >= 0:
            facet, r, s, outside = wall.facet_under(surface, cell_bin, place[0], y)
            if facet >= 0:
                if surface.by_border[facet]:
                    share, by_x, by_y = wall.cover(
                        surface.search, cell_bin, place[0], y, face.size, outside
                    )
                nodes = wall.nodes_of(surface, facet)
                height = wall.heights(surface, touch.displacement, face.axis, nodes)
    if share == 0.0:
        facet = -1
    penetration = -np.inf
    if facet >= 0:
        weight = wall.functions(surface.quadratic, r, s)
        penetration = face.sign * (level - wall.blend(weight, height))
    return Spot(
        facet=facet,
        height=height,
        r=r,
        s=s,
        penetration=penetration,
        share=share,
        by_x=by_x,
        by_y=by_y,
    )


@inlined
def nearest_wall(touch, face):
    """Lower bound (m) of the wall under a face along the outward normal; infinity without a
    wall."""
    search, surface = touch.surface.search, touch.surface
    wide = 3 - face.axis
    half_x = abs(face.along[0]) + abs(face.across[0])
    half_y = abs(face.along[wide]) + abs(face.across[wide])
    low, scale = search.low[face.wall], search.per_length[face.wall]
    first = _bin(face.middle[0] - half_x, low[0], scale[0], search.bins[face.wall, 0])
    last = _bin(face.middle[0] + half_x, low[0], scale[0], search.bins[face.wall, 0])
    left = _bin(face.middle[wide] - half_y, low[1], scale[1], search.bins[face.wall, 1])
    right = _bin(face.middle[wide] + half_y, low[1], scale[1], search.bins[face.wall, 1])
    least, most, by_border = np.inf, -np.inf, False
    for i in range(first, last + 1):
        for j in range(left, right + 1):
            cell_bin = search.first_bin[face.wall] + i * search.bins[face.wall, 1] + j
            by_border = by_border or search.first_edge[cell_bin] < search.first_edge[cell_bin + 1]
            for k in range(search.first_facet[cell_bin], search.first_facet[cell_bin + 1]):
                nodes = wall.nodes_of(surface, search.facet[k])
                height = wall.heights(surface, touch.displacement, face.axis, nodes)
                lower, upper = wall.extremes(surface.quadratic, height, face.sign)
                least, most = min(least, lower), max(most, upper)
    if by_border and least < most:
        # Cells over the border see the wall continued by half a cell; twice that distance is safe.
        reach = face.size[0] * scale[0] + face.size[1] * scale[1]
        least -= reach * (most - least)
    return least


@inlined
def _bin(place, low, per_length, count):
    return min(max(int((place - low) * per_length), 0), count - 1)


@inlined
def press(touch, friction, face, place, spot):
    """Forces between a cell at ``place`` (m) and the wall that it penetrates at ``spot``."""
    surface, centre = touch.surface, touch.pose.centre
    nodes = wall.nodes_of(surface, spot.facet)
    weight = wall.functions(surface.quadratic, spot.r, spot.s)
    slope_x, slope_y = wall.slopes(surface, spot.facet, spot.r, spot.s, spot.height)
    # Outward gradient of the penetration.
    g = _in_frame(face.axis, -face.sign * slope_x, face.sign, -face.sign * slope_y)
    touch.load.pressed += 1
    push = touch.interface_stiffness * face.area * spot.share * spot.penetration
    touch.load.stored += 0.5 * push * spot.penetration
    edge = 0.5 * touch.interface_stiffness * face.area * spot.penetration * spot.penetration
    border = _in_frame(face.axis, edge * spot.by_x, 0.0, edge * spot.by_y)
    arm = (place[0] - centre[0], place[1] - centre[1], place[2] - centre[2])
    drag = _friction_on_payload(friction, touch, (nodes, weight), g, arm, push)
    normal = (
        -push * g[0] - border[0],
        -push * g[1] - border[1],
        -push * g[2] - border[2],
    )
    for corner in range(6 if surface.quadratic is not None else 4):
        touch.contact[nodes[corner], face.axis] -= weight[corner] * push * face.sign
    _add_to_payload(touch, face.number, place, arm, normal, drag)
    _note_nodes(touch, nodes)


@inlined
def _in_frame(axis, x, normal, across):
    """Frame components of a vector, from those along X, along the normal of a wall and across."""
    found = (x, across, normal)
    if axis == 1:
        found = (x, normal, across)
    return found


@inlined
def _friction_on_payload(friction, touch, node, g, arm, push):
    """Friction force (N) on the payload; zero without friction.

    Also sums its moment, and gives each node the opposite force and its damping (N s/m). ``g``:
    gradient of the penetration; ``push`` (N): normal force over the length of ``g``; ``node``:
    numbers and weights of the nodes.
    """
    drag = (0.0, 0.0, 0.0)
    if rubs(friction):
        touch.load.rubbed += 1
        nodes, weight = node
        active = touch.active
        slide = _sliding_velocity(touch, nodes, weight, arm)
        size = np.sqrt(rotation.dot(g, g))
        along = rotation.dot(slide, g) / (size * size)
        t = (slide[0] - along * g[0], slide[1] - along * g[1], slide[2] - along * g[2])
        damping = push * size * coefficient_over_speed(friction, np.sqrt(rotation.dot(t, t)))
        drag = (-damping * t[0], -damping * t[1], -damping * t[2])
        moment = rotation.cross(arm, drag)
        for i in range(3):
            touch.load.friction_force[i] += drag[i]
            touch.load.friction_moment[i] += moment[i]
        total = 0.0
        for corner in range(6):
            total += abs(weight[corner])
        for corner in range(6 if touch.surface.quadratic is not None else 4):
            number, share = nodes[corner], weight[corner]
            active.node_damping[number] += abs(share) * total * damping
            for i in range(3):
                active.drag[number, i] += share * drag[i]
                touch.contact[number, i] += share * drag[i]
    return drag


@inlined
def _sliding_velocity(touch, nodes, weight, arm):
    """Velocity (m/s) of the payload's material at ``arm`` (m) from its mass centre, relative to the
    wall."""
    pose, velocity = touch.pose, touch.velocity
    spin = rotation.cross(pose.rate, arm)
    x, y, z = pose.velocity[0] + spin[0], pose.velocity[1] + spin[1], pose.velocity[2] + spin[2]
    for corner in range(6 if touch.surface.quadratic is not None else 4):
        number, share = nodes[corner], weight[corner]
        x -= share * velocity[number, 0]
        y -= share * velocity[number, 1]
        z -= share * velocity[number, 2]
    return x, y, z


@inlined
def _add_to_payload(touch, face, place, arm, normal, drag):
    """Add forces (N) to the payload at ``place`` (m); the opposite forces act on rails and frame at
    the same place."""
    load = touch.load
    total = (normal[0] + drag[0], normal[1] + drag[1], normal[2] + drag[2])
    moment, about_origin = rotation.cross(arm, total), rotation.cross(place, total)
    for i in range(3):
        load.normal_force[i] += normal[i]
        load.moment[i] += moment[i]
        load.moment_on_rail[i] -= about_origin[i]
        touch.face_force[face, i] += total[i]
        touch.face_moment[face, i] += moment[i]


@inlined
def _note_nodes(touch, nodes):
    surface, active, group = touch.surface, touch.active, touch.group
    for corner in range(6 if surface.quadratic is not None else 4):
        node = nodes[corner]
        if not active.seen[node]:
            active.seen[node] = True
            active.node[surface.groups.first_node[group] + active.node_count[group]] = node
            active.node_count[group] += 1


@kernel
def probe(touch, face):
    """Largest penetration (m) of the cells of a face over the wall: of those inside the wall, and
    of all."""
    cells, inside, behind = touch.surface.cells, 0.0, 0.0
    spot = no_spot()
    for row in range(cells[face.number, 0]):
        for column in range(cells[face.number, 1]):
            spot = spot_under(touch, face, place_of(touch, face, row, column), spot)
            if spot.facet >= 0:
                behind = max(behind, spot.penetration)
                if spot.penetration < touch.surface.thickness:
                    inside = max(inside, spot.penetration)
    return inside, behind


@inlined
def rate_damping(touch, friction):
    """Largest damping / mass (1/s) of a node, for the stability check."""
    if rubs(friction):
        active, load = touch.active, touch.load
        first = touch.surface.groups.first_node[touch.group]
        for k in range(first, first + active.node_count[touch.group]):
            node = active.node[k]
            load.damping_rate = max(
                load.damping_rate, active.node_damping[node] * touch.inverse_mass[node]
            )
