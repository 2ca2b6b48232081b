"""The sliding impact of ``impact_problem`` in 27-node hexahedra of scikit-fem with a leapfrog in NumPy.

No code of the solvers is used. The stiffness is from scikit-fem. The mass is lumped by Simpson's rule
with the nodes as points. The contact is a sum over a grid of points of the pad. The block moves in the
plane y = 0: x, z and pitch.

    M v' = f - K u,    p = wall(x) - z > 0:  dN = k p dA,   friction mu N against the slip
"""

import time as clock
from functools import partial
from importlib import metadata
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh
from skfem import Basis, ElementHex2, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity

from validation.peers import impact_problem as case
from validation.peers.case import OURS, Case, Point, percent, timed

_GRID = 48  # points along each edge of the pad
_SAFETY = 0.9


class Bar(NamedTuple):
    """The bar with its ends held."""

    stiffness: csr_array  # (d,d) N/m of the free degrees of freedom
    inverse_mass: np.ndarray  # (d,) 1/kg
    x: np.ndarray  # (p,) m, nodes of the upper side along x
    y: np.ndarray  # (q,) m
    across: np.ndarray  # (p,q) numbers of their free degrees of freedom along z, -1 where held
    along: np.ndarray  # (p,q) along x


def bar(size: float) -> Bar:
    """The bar in elements of ``size`` (m)."""
    half = (0.5 * case.LENGTH, 0.5 * case.WIDTH)
    lines = [np.linspace(-h, h, round(2.0 * h / size) + 1) for h in half]
    lines.append(np.linspace(-case.DEPTH, 0.0, round(case.DEPTH / size) + 1))
    mesh = MeshHex.init_tensor(*lines)
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=4)
    stiffness = linear_elasticity(*lame_parameters(case.MODULUS, case.RATIO)).assemble(basis)
    x, y, z = basis.doflocs
    counts = [2 * (len(line) - 1) for line in lines]
    mass = case.DENSITY * np.prod(
        [
            _simpson(place, line[0], line[-1], count)
            for place, line, count in zip((x, y, z), lines, counts)
        ],
        axis=0,
    )
    free = np.setdiff1d(np.arange(basis.N), np.union1d(_at(x, -half[0]), _at(x, half[0])))
    number = np.full(basis.N, -1)
    number[free] = np.arange(free.size)
    xs, ys = (np.linspace(-h, h, count + 1) for h, count in zip(half, counts))
    grids = []
    for name in ("u^3", "u^1"):
        chosen = np.intersect1d(basis.get_dofs(elements=True).all(name), _at(z, 0.0))
        grid = np.full((xs.size, ys.size), -1)
        i, j = (
            np.round((place[chosen] - line[0]) / (line[1] - line[0])).astype(int)
            for place, line in ((x, xs), (y, ys))
        )
        grid[i, j] = number[chosen]
        grids.append(grid)
    inner = csr_array(stiffness)[free][:, free]
    return Bar(inner, 1.0 / mass[free], x=xs, y=ys, across=grids[0], along=grids[1])


def _at(place: np.ndarray, value: float) -> np.ndarray:
    return np.flatnonzero(np.abs(place - value) < 1e-9)


def _simpson(place: np.ndarray, low: float, high: float, count: int) -> np.ndarray:
    """Weights (m) of Simpson's rule over ``count`` equal intervals, at each of ``place``."""
    step = (high - low) / count
    number = np.round((place - low) / step).astype(int)
    weight = np.where(number % 2 == 1, 4.0, 2.0)
    return step / 3.0 * np.where((number == 0) | (number == count), 1.0, weight)


def solve(size: float, factor: float) -> dict[str, float]:
    """The quantities of ``impact_problem.solve`` and the processor time."""
    began = clock.thread_time()
    of = bar(size)
    step = _SAFETY * _critical(of)
    count = int(np.ceil(case.DURATION / step))
    step = case.DURATION / count
    displacement, speed = np.zeros_like(of.inverse_mass), np.zeros_like(of.inverse_mass)
    # x, z and pitch of the block; z is that of the mass centre above the bar
    place = np.array([case.START, case.HEIGHT + case.GAP, 0.0])
    motion = np.array([case.SPEED, -case.APPROACH, 0.0])
    inverse = 1.0 / np.array([case.MASS, case.MASS, case.INERTIA])
    pad = Pad(of, factor * case.STIFFNESS)
    for number in range(count):
        force, load = pad.press(place, motion, displacement, speed)
        kick = step if number else 0.5 * step
        speed += kick * of.inverse_mass * (load - of.stiffness @ displacement)
        motion = motion + kick * inverse * force
        displacement += step * speed
        place = place + step * motion
    return {
        "rebound": float(motion[1]),
        "pitch rate": float(motion[2]),
        "normal impulse": case.MASS * float(motion[1] + case.APPROACH),
        "friction impulse": case.MASS * float(motion[0] - case.SPEED),
        "cpu_s": clock.thread_time() - began,
    }


def _critical(of: Bar) -> float:
    """Critical step (s) of the leapfrog."""
    root = np.sqrt(of.inverse_mass)
    scaled = csr_array(of.stiffness.multiply(root[:, None]).multiply(root))
    start = np.random.default_rng(1).standard_normal(root.size)
    largest = eigsh(scaled, 1, which="LA", v0=start, tol=1e-4, return_eigenvectors=False)
    return 2.0 / float(np.sqrt(largest[0]))


class Pad:
    """The crowned pad as a grid of points."""

    def __init__(self, of: Bar, stiffness: float):
        self.bar, self.stiffness = of, stiffness
        middles = (np.arange(_GRID) + 0.5) / _GRID * 2.0 - 1.0
        xi, eta = (part.ravel() for part in np.meshgrid(middles, middles, indexing="ij"))
        self.x, self.y = 0.5 * case.PAD * xi, 0.5 * case.PAD * eta
        self.crown = case.RELIEF * (xi**4 + eta**4)
        self.area = (case.PAD / _GRID) ** 2

    def press(self, place, motion, displacement, speed) -> tuple[np.ndarray, np.ndarray]:
        """Force (3,) on the block along x, z and about y, and the load (d,) N on the bar."""
        load = np.zeros_like(displacement)
        sine, cosine = np.sin(place[2]), np.cos(place[2])
        down = -case.HEIGHT + self.crown
        # the pitch turns z towards x
        arm_x, arm_z = cosine * self.x + sine * down, -sine * self.x + cosine * down
        level = place[1] + arm_z
        if level.min() > displacement.max(initial=0.0):
            return np.zeros(3), load
        nodes, weight = self._under(place[0] + arm_x)
        across, along = self._values(nodes[0], weight, displacement), nodes[1]
        depth = across - level
        inside = np.flatnonzero(depth > 0.0)
        push = self.stiffness * self.area * depth[inside]
        slip = motion[0] + motion[2] * arm_z[inside]
        slip = slip - self._values(along[inside], weight[inside], speed)
        drag = -case.FRICTION * push * np.sign(slip)
        for grid, value in ((nodes[0], -push), (along, -drag)):
            share = weight[inside] * value[:, None]
            number = grid[inside]
            np.add.at(load, number[number >= 0], share[number >= 0])
        moment = arm_z[inside] @ drag - arm_x[inside] @ push
        return np.array([drag.sum(), push.sum(), moment]), load

    def _values(self, nodes: np.ndarray, weight: np.ndarray, field: np.ndarray) -> np.ndarray:
        return (weight * np.where(nodes >= 0, field[nodes], 0.0)).sum(axis=1)

    def _under(self, x: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
        """Numbers (g,9), along z and x, and weights (g,9) of the nodes around each point."""
        of = self.bar
        i, along = _quadratic(x, of.x)
        j, over = _quadratic(self.y, of.y)
        rows, columns = i[:, None] + np.arange(3), j[:, None] + np.arange(3)
        weight = (along[:, :, None] * over[:, None]).reshape(len(x), 9)
        picked = rows[:, :, None], columns[:, None]
        return (of.across[picked].reshape(-1, 9), of.along[picked].reshape(-1, 9)), weight


def _quadratic(place: np.ndarray, line: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First node (g,) and values (g,3) of the quadratic functions on the element around each of
    ``place``; ``line``: places of corners and middles."""
    first = 2 * np.clip(
        ((place - line[0]) / (line[2] - line[0])).astype(int), 0, line.size // 2 - 1
    )
    r = (place - line[first + 1]) / (line[1] - line[0])
    return first, np.column_stack([0.5 * r * (r - 1.0), 1.0 - r * r, 0.5 * r * (r + 1.0)])


SETTINGS = {
    f"{theirs:g} mm, ours {ours:g} mm, interface times {factor:g}": (theirs, ours, factor)
    for theirs, ours in ((4.0, 2.0), (3.0, 1.0))
    for factor in (0.25, 1.0, 4.0)
}


def version() -> str:
    """Version of scikit-fem, which the project itself requires."""
    return metadata.version("scikit-fem")


def _work() -> list[Point]:
    """Normal impulse, against quadratic elements of 3 mm."""
    exact, _ = timed(lambda: solve(3e-3, 1.0))
    points = []
    for code, solver, sizes in (
        (OURS, case.solve, (4.0, 2.0, 1.0)),
        ("scikit-fem and NumPy", solve, (6.0, 4.0)),
    ):
        for size in sizes:
            found, spent = timed(partial(solver, 1e-3 * size, 1.0))
            error = percent(found["normal impulse"], exact["normal impulse"])
            points.append(Point(code, f"{size:g} mm", error, spent))
    return points


def cases() -> tuple[Case, ...]:
    """The sliding impact at two meshes and three values of the interface stiffness."""
    return (
        Case(
            name="quadratic-impact",
            title="A rigid block slides along an elastic bar between two clamps and strikes it",
            inputs=case.inputs,
            matched="geometry, material, pad and its crown, interface stiffness, friction",
            unmatched="27-node elements against ours of 8 nodes with incompatible modes; the pad's "
            "points, 48 along an edge against 16, which is most of what is left at four times the "
            "interface stiffness; the slope of the wall, which the peer leaves out of the normal",
            settings=tuple(SETTINGS),
            units=dict(case.UNITS),
            ours=lambda name: case.solve(1e-3 * SETTINGS[name][1], SETTINGS[name][2]),
            theirs=lambda name: solve(1e-3 * SETTINGS[name][0], SETTINGS[name][2]),
            within=lambda setting, quantity: 5e-3,
            slow=tuple(name for name, (_, ours, _) in SETTINGS.items() if ours < 2.0),
            work=_work,
            error_of="normal impulse of an impact",
        ),
    )
