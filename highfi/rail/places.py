"""Places on a rail under the pad faces, and the displacement of each under unit pressures on the
others."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array, hstack

from tipoff.highfi.contact import surface
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.state.threads import processors
from tipoff.highfi.statics import joint_terms, thermal
from tipoff.highfi.statics.chain import Chain
from tipoff.highfi.statics.held import HeldRail
from tipoff.highfi.statics.pressure import Pressed, Wall
from tipoff.highfi.statics.solve import Clamped, one_thread
from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.model import Faces
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.mechanics.rail_compliance.patterns import LOW_DEGREE, count

# of the length of a pad: the least length of the part of its wall that is seen near an end of the
# rail, so that the patterns keep well apart; for patterns of the second degree, and for others
_LEAST_PART, _LEAST_PART_OF_MORE = 0.5, 0.75
BATCH = 64  # loads solved for at once; bounds the memory
_MOST_THREADS = 8  # also bounds the memory
_DIGITS = 9  # decimals of a place in m; faces at equal places share one solution


# Called with the solved fraction of the loads, or with that of another part of the work and its name. As
# an argument, it would pass through every function below.
_PROGRESS: ContextVar[Callable[..., None] | None] = ContextVar("progress", default=None)


@contextmanager
def progress_to(report: Callable[..., None]) -> Iterator[None]:
    """Context in which this thread's calls ``report`` the solved fraction of the loads, from 0 to 1,
    and of other parts of the work with their names."""
    before = _PROGRESS.set(report)
    try:
        yield
    finally:
        _PROGRESS.reset(before)


def reported() -> Callable[..., None]:
    """The function given to ``progress_to`` in this thread, or one that does nothing."""
    return _PROGRESS.get() or (lambda *_: None)


@contextmanager
def one_of(number: int, count: int) -> Iterator[None]:
    """Context in which fractions are those of the rail ``number`` of ``count``, on one scale."""
    whole = reported()
    with progress_to(lambda fraction, *part: whole((number + fraction) / count, *part)):
        yield


class Lines(NamedTuple):
    """Places on at most n nodes, in ``lines`` across the rail with the same number of nodes each. A place
    with fewer repeats its first node, without load."""

    lines: int
    normal: (
        np.ndarray
    )  # (p,n) places (``Chain.placed``) of the degrees of freedom normal to the wall
    along: np.ndarray  # (p,n) and along X
    load: np.ndarray  # (p,c,n) of each pattern, positive along the normal of the face


class Patches:
    """All different places on one rail that are under a face; the rail also stands for its mirror
    images. A face has so many ``patterns`` of pressure, the first of them ``dragged`` along X by
    friction too."""

    def __init__(self, rail: RailMesh, patterns: int, dragged: int = 0):
        self._rail, self._patterns, self._dragged = rail, patterns, dragged
        self._facets = np.concatenate(
            [group for name, group in sorted(rail.surfaces.items()) if name.startswith("contact")]
        )
        self._number: dict[tuple, int] = {}
        self._direction: list[tuple[int, float]] = []  # axis and sign of the pressure
        self.found: list[Pressed] = []

    def under(
        self,
        faces: Faces,
        half: np.ndarray,
        signs: np.ndarray,
        reach: tuple[float, float],
        travel: np.ndarray,
    ) -> np.ndarray:
        """Number (s,f) of the place under each face, -1 without one; ``signs`` (3,) map the rail to
        its image."""
        axis, across = faces.axis, 3 - faces.axis
        seen = faces._replace(
            centre=faces.centre * signs,
            sign=faces.sign * signs[axis],
            wall=faces.wall * signs[axis],
        )
        number = np.full((travel.size, axis.size), -1)
        for face in range(axis.size):
            facets = self._facets[surface.in_reach(self._rail.points[self._facets], seen, face)]
            if not facets.size:
                continue
            wall = Wall(self._rail.points, facets, across[face])
            middles = seen.centre[face, 0] + travel
            parts = part_of_wall(middles, half[face, 0], reach, self._patterns)
            for station, (x, long) in enumerate(parts):
                size = np.array([long, half[face, 1] * signs[across[face]]])
                middle = np.array([x, seen.centre[face, across[face]]])
                key = (
                    axis[face],
                    seen.sign[face],
                    *np.round([*middle, *size, seen.wall[face]], _DIGITS),
                )
                if key not in self._number:
                    patch = wall.pressed(middle, size, self._patterns)
                    self._number[key] = -1 if patch is None else len(self.found)
                    if patch is not None:
                        self.found.append(patch)
                        self._direction.append((axis[face], seen.sign[face]))
                number[station, face] = self._number[key]
        return number

    def solved(
        self, held: HeldRail, middle: float, modes: int, pairs: np.ndarray, joints: bool
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, joint_terms.Terms | None]:
        """Displacement (q,p,p+d) in m of the first place of each of the ``pairs`` (q,2) under the
        loads of the second, normals of the faces positive: p pressures, then d tractions along X;
        and (m,p,t) of all places under a unit
        of each field of temperature around X = ``middle`` (m); frequencies (n,) rad/s of the lowest
        modes and their displacement (m,p+d,n), the last d along X; with ``joints`` and modes, the terms of a joint."""
        operator, loads = held.operator, self.loads()
        clamped = held.clamped(loads.shape[1])
        load, still = thermal.of_each_field(self._rail, operator, held.material, middle)
        warm = loads.T @ clamped.displaced(load, still)
        loads, drag = loads[clamped.free], self.loads(friction=True)[clamped.free]
        answer = _under_each_other(clamped, loads, drag, pairs, self._patterns)
        frequency, shape = held.modes(modes)
        terms = None
        if joints and operator.joints is not None and modes:
            heat = load + operator.joints @ still
            direct = answer[pairs[:, 0] == pairs[:, 1], :, : self._patterns]
            own = np.einsum("maa->ma", direct).ravel()
            both = joint_terms.Loads(loads, drag, heat)
            terms = joint_terms.solved(operator, clamped, both, shape, own)
        under = len(self.found), self._patterns
        return (
            answer,
            warm.reshape(*under, FIELDS),
            frequency,
            np.concatenate(
                [_by_place(each, shape, len(self.found)) for each in (loads, drag)], axis=1
            ),
            terms,
        )

    def toward(self, place: int) -> float:
        """Sign of the axis normal to the wall in which a pad presses a place."""
        return self._direction[place][1]

    def by_lines(self, free: np.ndarray, chain: Chain) -> "Lines | None":
        """All places with their nodes by layers of the ``chain`` over the ``free`` (3n,) degrees of
        freedom; None if layers under a place have different numbers of nodes, or a node is fixed."""
        number = np.cumsum(free) - 1
        sizes = [patch.node.size for patch in self.found]
        axis = np.array([axis for axis, _ in self._direction])
        node = np.concatenate([patch.node for patch in self.found])
        normal, along = 3 * node + np.repeat(axis, sizes), 3 * node
        if not (free[normal].all() and free[along].all()):
            return None
        normal, along = chain.placed(number[normal]), chain.placed(number[along])
        place = np.repeat(np.arange(len(sizes)), sizes)
        order = np.lexsort((normal, place))
        layer = chain.layer(normal[order])
        line = np.flatnonzero((np.diff(place, prepend=-1) != 0) | (np.diff(layer, prepend=-1) != 0))
        width = np.unique(np.diff([*line, layer.size]))
        if width.size > 1:
            return None
        most = max(sizes)
        first = np.cumsum([0, *sizes[:-1]])
        slot = np.arange(layer.size) - np.repeat(first, sizes)
        found = np.repeat(order[first, None], most, axis=1)
        found[place, slot] = order
        load = np.zeros((len(sizes), self._patterns, most))
        toward = np.repeat([sign for _, sign in self._direction], sizes)
        every = np.concatenate([patch.load for patch in self.found], axis=1) * toward
        load[place, :, slot] = every[:, order].T
        return Lines(most // int(width[0]), normal[found], along[found], load)

    def loads(self, friction: bool = False) -> csc_array:
        """Nodal loads (3n,mp) of all patterns at all places, or the tractions (3n,md) along X."""
        size = self._dragged if friction else self._patterns
        rows, columns, values = [], [], []
        for number, (patch, (axis, sign)) in enumerate(zip(self.found, self._direction)):
            along, toward = (0, 1.0) if friction else (axis, sign)
            load = patch.load[:size]
            rows.append(np.broadcast_to(3 * patch.node + along, load.shape).ravel())
            columns.append(np.repeat(number * size + np.arange(size), patch.node.size))
            values.append(toward * load.ravel())
        shape = (3 * len(self._rail.points), len(self.found) * size)
        return csc_array(
            coo_array(
                (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                shape=shape,
            )
        )


def _by_place(loads: csc_array, shape: np.ndarray, places: int) -> np.ndarray:
    """Displacement (m,p,n) in each ``shape`` (3n,n) of the ``loads`` (3n,mp) of so many ``places``."""
    return (loads.T @ shape).reshape(places, loads.shape[1] // places, shape.shape[1])


def part_of_wall(
    middle: np.ndarray, half: float, reach: tuple[float, float], patterns: int = PATTERNS
) -> np.ndarray:
    """Middle and half length (s,2) m of the part of a wall between the X of ``reach`` under a face of
    half length ``half`` with its middle at X = ``middle`` (s,) m. Near an end, and past it, it is
    the last half of a pad, or three quarters for ``patterns`` of a degree above the second."""
    share = _LEAST_PART if patterns <= count(LOW_DEGREE) else _LEAST_PART_OF_MORE
    least = min(2.0 * half * share, reach[1] - reach[0])
    low = np.clip(middle - half, reach[0], reach[1] - least)
    high = np.clip(middle + half, reach[0] + least, reach[1])
    return np.stack([0.5 * (low + high), 0.5 * (high - low)], axis=-1)


def pressed_together(
    places: list[np.ndarray], count: int, beside: np.ndarray
) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """All pairs (q,2) of the ``count`` places that are pressed at the same travel, ascending, for
    ``places`` (s,f) under the faces of each image, with the faces ``beside`` (f,m) each on its rail;
    and the function from such an array to the number (s,f,m) of the pair, -1 without a wall."""

    def keys(number: np.ndarray) -> np.ndarray:
        first, second = number[:, :, None], number[:, beside]
        return np.where((first >= 0) & (second >= 0) & (beside >= 0), first * count + second, -1)

    every = np.unique(np.concatenate([keys(number).ravel() for number in places]))
    every = every[every >= 0]

    def number_of(number: np.ndarray) -> np.ndarray:
        key = keys(number)
        return np.where(key >= 0, np.searchsorted(every, key), -1)

    return np.stack(np.divmod(every, count), axis=1), number_of


def _under_each_other(
    clamped: Clamped, loads: csc_array, drag: csc_array, pairs: np.ndarray, width: int
) -> np.ndarray:
    """Displacement (q,w,w+d) of the first place of each of the ``pairs`` (q,2) under the second,
    L' K^-1 [L, X], for ``loads`` L (d,mw) with ``width`` columns for each place and the tractions
    ``drag`` X (d,md). Without a chain, threads solve batches in parallel; the bits of a batch do not
    depend on the others."""
    report, places = reported(), loads.shape[1] // width
    dragged = drag.shape[1] // places
    if clamped.chain is not None:
        every = _side_by_side(loads, drag, places)
        with one_thread():
            found = clamped.chain.under(every, pairs, width + dragged, report)
        return found[:, :width]
    answer = []
    starts = range(0, loads.shape[1], BATCH)

    def under(start: int) -> tuple[np.ndarray, np.ndarray]:
        moved = clamped.solve(loads[:, start : start + BATCH].toarray())
        return loads.T @ moved, drag.T @ moved

    with one_thread(), ThreadPoolExecutor(min(_MOST_THREADS, processors())) as pool:
        for start, both in zip(starts, pool.map(under, starts)):
            answer.append(both)
            report(min(start + BATCH, loads.shape[1]) / loads.shape[1])
    pressed, moved = (np.concatenate(each, axis=1) for each in zip(*answer))
    pressed = pressed.reshape(places, width, places, width)[pairs[:, 0], :, pairs[:, 1]]
    # the displacement along X of the second place under the pressure on the first (Maxwell, Betti)
    moved = moved.reshape(places, dragged, places, width)[pairs[:, 1], :, pairs[:, 0]]
    return np.concatenate([pressed, moved.transpose(0, 2, 1)], axis=2)


def _side_by_side(loads: csc_array, drag: csc_array, places: int) -> csc_array:
    """Loads and tractions of each of the ``places`` in neighbouring columns."""
    width, dragged = loads.shape[1] // places, drag.shape[1] // places
    place = np.arange(places)[:, None]
    order = np.concatenate(
        [place * width + np.arange(width), places * width + place * dragged + np.arange(dragged)],
        axis=1,
    )
    return csc_array(hstack([loads, drag], format="csc")[:, order.ravel()])
