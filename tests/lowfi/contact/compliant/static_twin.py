"""Static twin of compliant contact: the cells of the finite-element reference on the walls of one
rail of the built-in section, whose nodes have their exact compliance, without patterns.

With the depth d of the cells on a wall at rest, their bilinear weights N on the wall nodes, and the
compliance G of these nodes, the displacement u of the pressed nodes and the pressed cells satisfy::

    u = G N' k A c (d - N u),    pressed: d - N u > 0

c is the share of a cell over the wall (``highfi.contact.wall``), A its area, k the interface
stiffness. Inertia and friction are left out. The cells of the surrogate divide the part of the face
that is over the wall instead, so that their share is one.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi import compliance
from tipoff.highfi.contact import surface
from tipoff.highfi.rail import inputs
from tipoff.mechanics.model import half_sizes
from tipoff.scenes.scene import Scene

_MOST = 60  # corrections of the set of pressed cells


class Cells(NamedTuple):
    """The c cells of one face at a pose."""

    xi: np.ndarray  # (c,)
    eta: np.ndarray  # (c,)
    depth: np.ndarray  # (c,) m into the wall at rest
    stiffness: np.ndarray  # (c,) N/m, of the part over the wall
    node: np.ndarray  # (c,4) numbers of wall nodes
    weight: np.ndarray  # (c,4) of the nodes


class Pressed(NamedTuple):
    """A face on the deformed wall."""

    force: float  # N, against the normal of the face
    moment: np.ndarray  # (2,) N m, of the pressure about the middle of the face: by xi and by eta
    xi: np.ndarray  # (c,) cells with a wall under them
    eta: np.ndarray  # (c,)
    displacement: np.ndarray  # (c,) m, of the wall away from the payload


class StaticTwin:
    """Statics of the first rail of ``scene`` in elements of ``element_size`` (m), under faces with
    so many ``cells`` along each edge, those of the reference, or of the surrogate if they
    ``follow`` the end of the rail."""

    def __init__(self, scene: Scene, element_size: float, cells: int, follow: bool = False):
        own = inputs.of_scene(scene)
        self.model_faces, self._half = own.faces, half_sizes(own.faces)
        self._reach, self._cells, self._follow = own.reach, cells, follow
        self._interface = scene.contact.series_stiffness()
        self.held = compliance.rails(scene, element_size)[0]
        points = self.held.rail.points
        wall = np.concatenate(
            [
                group
                for name, group in sorted(self.held.rail.surfaces.items())
                if name.startswith("contact")
            ]
        )
        facets = {
            face: wall[found]
            for face in range(own.faces.axis.size)
            if (found := surface.in_reach(points[wall], own.faces, face)).size
        }
        self.faces = list(facets)
        axis = own.faces.axis
        freedom = [3 * np.unique(facets[face]) + axis[face] for face in self.faces]
        self.freedom = np.unique(np.concatenate(freedom))
        self._grid = {face: self._lines(points, facets[face], axis[face]) for face in self.faces}
        self._solve_units()

    def _lines(self, points, facets, axis) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """X (n,) and places across (m,) of the lines of nodes of a wall, and the numbers (n,m) of
        their freedoms."""
        nodes = np.unique(facets)
        place = np.round(points[nodes][:, [0, 3 - axis]], 9)
        x, y = (np.unique(column) for column in place.T)
        assert nodes.size == x.size * y.size
        grid = np.empty((x.size, y.size), dtype=np.int64)
        at = np.searchsorted(x, place[:, 0]), np.searchsorted(y, place[:, 1])
        grid[at] = np.searchsorted(self.freedom, 3 * nodes + axis)
        return x, y, grid

    def _solve_units(self) -> None:
        """Fill the compliance (n,n) m/N of the freedoms."""
        clamped = self.held.clamped(0)
        number = np.cumsum(clamped.free) - 1
        free = np.flatnonzero(clamped.free[self.freedom])
        loads = np.zeros((number[-1] + 1, self.freedom.size))
        loads[number[self.freedom[free]], free] = 1.0
        self.compliance = np.zeros((self.freedom.size, self.freedom.size))
        self.compliance[free] = clamped.solve(loads)[number[self.freedom[free]]]

    def cells(self, face: int, place: np.ndarray, turn: np.ndarray) -> Cells:
        """Cells with a wall under them, of the payload displaced by ``place`` (3,) m from ignition
        and turned by ``turn`` (3,3)."""
        faces, half, count = self.model_faces, self._half[face], self._cells
        axis, sign = faces.axis[face], faces.sign[face]
        edges = np.linspace(-1.0, 1.0, count + 1)
        middle = (place + turn @ faces.centre[face])[0]
        ends = ((np.array(self._reach) - middle) / half[0]).clip(-1.0, 1.0)
        rows = np.linspace(*ends, count + 1) if self._follow and ends[0] < ends[1] else edges
        (node, row_crown), (across, crown) = _middles(rows), _middles(edges)
        xi, eta = (grid.ravel() for grid in np.meshgrid(node, across, indexing="ij"))
        arm = np.zeros((xi.size, 3))
        arm[:, 0], arm[:, 3 - axis] = half[0] * xi, half[1] * eta
        arm[:, axis] = -sign * faces.relief[face] * np.add.outer(row_crown, crown).ravel()
        at = place + (faces.centre[face] + arm) @ turn.T
        way = np.minimum(at[:, 0] - self._reach[0], self._reach[1] - at[:, 0])
        share = np.clip(0.5 + 0.5 * count * way / half[0], 0.0, 1.0)
        if self._follow:
            share[:] = 0.5 * (ends[1] - ends[0])
        on = share > 0.0
        stiffness = self._interface * 4.0 * abs(half.prod()) / count**2 * share
        x, y, grid = self._grid[face]
        (i, r), (j, s) = _between(x, at[on, 0]), _between(y, at[on, 3 - axis])
        corners = grid[i, j], grid[i + 1, j], grid[i, j + 1], grid[i + 1, j + 1]
        return Cells(
            xi=xi[on],
            eta=eta[on],
            depth=sign * (at[on, axis] - faces.wall[face]),
            stiffness=stiffness[on],
            node=np.stack(corners, axis=1),
            weight=np.stack([(1 - r) * (1 - s), r * (1 - s), (1 - r) * s, r * s], axis=1),
        )

    def solve(
        self, place: np.ndarray, turn: np.ndarray, faces: list[int] | None = None
    ) -> dict[int, Pressed]:
        """Equilibrium under the ``faces`` (all by default) that press. Fills ``load``, the forces
        (n,) N on the freedoms."""
        found = {
            face: self.cells(face, place, turn) for face in (self.faces if faces is None else faces)
        }
        node = np.concatenate([each.node for each in found.values()])
        sign = np.concatenate(
            [np.full(each.depth.size, self.model_faces.sign[face]) for face, each in found.items()]
        )
        weight = sign[:, None] * np.concatenate([each.weight for each in found.values()])
        depth = np.concatenate([each.depth for each in found.values()])
        stiffness = np.concatenate([each.stiffness for each in found.values()])
        touched, row = np.unique(node, return_inverse=True)
        seen = np.zeros((depth.size, touched.size))
        np.put_along_axis(seen, row.reshape(node.shape), weight, axis=1)
        between = self.compliance[np.ix_(touched, touched)]
        pressed, moved = depth > 0.0, np.zeros(depth.size)
        for _ in range(_MOST):
            spring = seen.T * (stiffness * pressed)
            moved = seen @ np.linalg.solve(
                np.eye(touched.size) + between @ (spring @ seen), between @ (spring @ depth)
            )
            before, pressed = pressed, depth > moved
            if (before == pressed).all():
                break
        else:
            raise AssertionError("the pressed cells do not settle")
        push = stiffness * np.maximum(0.0, depth - moved)
        self.load = np.zeros(self.freedom.size)
        self.load[touched] = seen.T @ push
        answer, start = {}, 0
        for face, each in found.items():
            own = slice(start, start + each.depth.size)
            start = own.stop
            half = self._half[face]
            answer[face] = Pressed(
                force=float(push[own].sum()),
                moment=half * [push[own] @ each.xi, push[own] @ each.eta],
                xi=each.xi,
                eta=each.eta,
                displacement=moved[own],
            )
        return answer

    def field(self) -> np.ndarray:
        """Displacement (n,3) m of all nodes of the rail under ``load``."""
        clamped = self.held.clamped(0)
        loads = np.zeros(clamped.free.size)
        loads[self.freedom] = self.load
        found = np.zeros(clamped.free.size)
        found[clamped.free] = clamped.solve(loads[clamped.free])
        return found.reshape(-1, 3)


def _middles(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles of cells, and the means of the fourth power over them."""
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges**5) / (5.0 * np.diff(edges))


def _between(lines: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Number of the line before each place, and the way from it as a part of the distance to the
    next; the first and last interval continue beyond the lines."""
    first = np.clip(np.searchsorted(lines, place) - 1, 0, lines.size - 2)
    return first, (place - lines[first]) / (lines[first + 1] - lines[first])
