"""Places on a rail under the pad faces, and the displacement of each under unit pressures on the
others."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from scipy.sparse import coo_array, csc_array

from tipoff.highfi.contact import surface
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.state.threads import processors
from tipoff.highfi.statics import joint_terms, thermal
from tipoff.highfi.statics.held import HeldRail
from tipoff.highfi.statics.pressure import Pressed, Wall
from tipoff.highfi.statics.solve import Clamped, one_thread
from tipoff.mechanics import scene_model
from tipoff.scenes.effects.thermal import FIELDS

# of the length of a pad: the least length of the part of its wall that is seen near an end of the
# rail, so that the patterns keep well apart
LEAST_PART = 0.5
BATCH = 64  # loads solved for at once; bounds the memory
_MOST_THREADS = 8  # also bounds the memory
_DIGITS = 9  # decimals of a place in m; faces at equal places share one solution


# Called with the solved fraction of the loads. As an argument, it would pass through every function
# below.
_PROGRESS: ContextVar[Callable[[float], None] | None] = ContextVar("progress", default=None)


@contextmanager
def progress_to(report: Callable[[float], None]) -> Iterator[None]:
    """Context in which this thread's calls ``report`` the solved fraction of the loads, from 0 to 1
    for each distinct rail."""
    before = _PROGRESS.set(report)
    try:
        yield
    finally:
        _PROGRESS.reset(before)


def reported() -> Callable[[float], None]:
    """The function given to ``progress_to`` in this thread, or one that does nothing."""
    return _PROGRESS.get() or (lambda _: None)


class Patches:
    """All different places on one rail that are under a face; the rail also stands for its mirror
    images."""

    def __init__(self, rail: RailMesh, patterns: int):
        self._rail, self._patterns = rail, patterns
        self._facets = np.concatenate(
            [group for name, group in sorted(rail.surfaces.items()) if name.startswith("contact")]
        )
        self._number: dict[tuple, int] = {}
        self._direction: list[tuple[int, float]] = []  # axis and sign of the pressure
        self.found: list[Pressed] = []

    def under(
        self,
        faces: scene_model.Faces,
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
            parts = part_of_wall(seen.centre[face, 0] + travel, half[face, 0], reach)
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
        self, held: HeldRail, middle: float, modes: int, pairs: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, joint_terms.Terms | None]:
        """Displacement (q,p,p) in m of the first place of each of the ``pairs`` (q,2) under the
        loads of the second, normals of the faces positive, and (m,p,t) of all places under a unit
        of each field of temperature around X = ``middle`` (m); frequencies (n,) rad/s of the lowest
        modes and their displacement (m,p,n); the terms of a joint if there are modes."""
        operator, loads = held.operator, self.loads()
        clamped = held.clamped(loads.shape[1])
        load, still = thermal.of_each_field(self._rail, operator, held.material, middle)
        warm = loads.T @ clamped.displaced(load, still)
        loads = loads[clamped.free]
        answer = _under_each_other(clamped, loads, pairs, self._patterns)
        frequency, shape = held.modes(modes)
        terms = None
        if operator.joints is not None and modes:
            heat = load + operator.joints @ still
            direct = answer[pairs[:, 0] == pairs[:, 1]]
            own = np.einsum("maa->ma", direct).ravel()
            terms = joint_terms.solved(operator, clamped, loads, heat, shape, own)
        under = len(self.found), self._patterns
        return (
            answer,
            warm.reshape(*under, FIELDS),
            frequency,
            (loads.T @ shape).reshape(*under, modes),
            terms,
        )

    def loads(self) -> csc_array:
        """Nodal loads (3n,mp) of all patterns at all places."""
        rows, columns, values = [], [], []
        for number, (patch, (axis, sign)) in enumerate(zip(self.found, self._direction)):
            rows.append(np.broadcast_to(3 * patch.node + axis, patch.load.shape).ravel())
            columns.append(
                np.repeat(number * self._patterns + np.arange(self._patterns), patch.node.size)
            )
            values.append(sign * patch.load.ravel())
        shape = (3 * len(self._rail.points), len(self.found) * self._patterns)
        return csc_array(
            coo_array(
                (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                shape=shape,
            )
        )


def part_of_wall(middle: np.ndarray, half: float, reach: tuple[float, float]) -> np.ndarray:
    """Middle and half length (s,2) m of the part of a wall between the X of ``reach`` under a face of
    half length ``half`` with its middle at X = ``middle`` (s,) m. Near an end, and past it, it is
    the last ``LEAST_PART``."""
    least = min(2.0 * half * LEAST_PART, reach[1] - reach[0])
    low = np.clip(middle - half, reach[0], reach[1] - least)
    high = np.clip(middle + half, reach[0] + least, reach[1])
    return np.stack([0.5 * (low + high), 0.5 * (high - low)], axis=-1)


def pressed_together(
    places: list[np.ndarray], count: int
) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """All pairs (q,2) of the ``count`` places that are pressed at the same travel, ascending, for
    ``places`` (s,f) under the faces of each image; and the function from such an array to the
    number (s,f,f) of the pair, -1 without a wall."""

    def keys(number: np.ndarray) -> np.ndarray:
        first, second = number[:, :, None], number[:, None, :]
        return np.where((first >= 0) & (second >= 0), first * count + second, -1)

    every = np.unique(np.concatenate([keys(number).ravel() for number in places]))
    every = every[every >= 0]

    def number_of(number: np.ndarray) -> np.ndarray:
        key = keys(number)
        return np.where(key >= 0, np.searchsorted(every, key), -1)

    return np.stack(np.divmod(every, count), axis=1), number_of


def _under_each_other(
    clamped: Clamped, loads: csc_array, pairs: np.ndarray, width: int
) -> np.ndarray:
    """Displacement (q,w,w) of the first place of each of the ``pairs`` (q,2) under the second,
    L' K^-1 L, for ``loads`` (d,mw) with ``width`` columns for each place. Without a chain, threads
    solve batches in parallel; the bits of a batch do not depend on the others."""
    report = reported()
    if clamped.chain is not None:
        with one_thread():
            return clamped.chain.under(loads, pairs, width, report)
    answer = []
    starts = range(0, loads.shape[1], BATCH)

    def under(start: int) -> np.ndarray:
        return loads.T @ clamped.solve(loads[:, start : start + BATCH].toarray())

    with one_thread(), ThreadPoolExecutor(min(_MOST_THREADS, processors())) as pool:
        for start, found in zip(starts, pool.map(under, starts)):
            answer.append(found)
            report(min(start + BATCH, loads.shape[1]) / loads.shape[1])
    every = np.concatenate(answer, axis=1).reshape(-1, width, loads.shape[1] // width, width)
    return every[pairs[:, 0], :, pairs[:, 1]]
