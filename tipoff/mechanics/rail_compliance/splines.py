"""Tables of a rail compliance between its stations, as the kernels of compliant contact read them."""

import threading
import weakref
from functools import cached_property

import numpy as np

from tipoff.mechanics.rail_compliance import pairs, residual
from tipoff.mechanics.rail_compliance.stations import between_faces, breaks, cubic

_KEEPING = threading.Lock()
# Bytes of F. Up to the first, splines are held for every number of modes; above it without modes and for one
# number; above the second for one number only, and for one order of a pair of faces.
SMALL, LARGE = 1e7, 1e8


class Splined:
    """Base of ``mechanics.rail_compliance.RailCompliance``, whose fields it interpolates."""

    travel: np.ndarray
    flexibility: np.ndarray | None
    rail: np.ndarray
    shape: np.ndarray
    part: np.ndarray | None
    dragged: np.ndarray | None

    @property
    def on_part(self) -> np.ndarray:
        """Patterns (s,f,p,p) of the parts of the faces that have a wall."""
        raise NotImplementedError

    def cubic(self, modes: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Flexibility (s-1,k,4,p p) in the blocks ``numbered`` between faces, without the part of the
        first ``modes``, and their shapes (s-1,f,n,4,p), between stations: coefficients
        of the rising powers of the distance (m) from the one before, in the patterns of the parts of the
        faces that have a wall. And the largest displacement (f,n) in a mode of a point under a face,
        or more. Raises ValueError as ``residual`` does."""
        found = self._cubics.get(modes)
        if found is None:
            self._make_room()
            shape, between = self.shape[..., :modes], self._between_faces(self.residual(modes))
            found = self._cubics[modes] = between, *self._of_modes(shape)
        return found

    def cubic_of_friction(self, modes: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """As ``cubic``, for the displacement by friction in the first d patterns: ``dragged`` without the
        part of the first ``modes`` (``residual.dragged``), their shapes along X (s-1,f,n,4,d), and the
        largest displacement (f,n) by these. None for walls that friction does not move."""
        if self.dragged is None:
            return None
        key = "friction", modes
        found = self._cubics.get(key)
        if found is None:
            shape = residual.along(self)[..., :modes]
            between = self._between_faces(residual.dragged(self, modes))
            found = self._cubics[key] = between, *self._of_modes(shape)
        return found

    def _of_modes(self, shape: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shapes (s,f,p,n) of modes between stations (s-1,f,n,4,p), and the largest displacement (f,n)
        of a point."""
        along = np.ascontiguousarray(self.cubic_of(shape).transpose(0, 1, 3, 4, 2))
        return along, np.abs(self._to_part(shape)).sum(axis=2).max(axis=0)

    def _make_room(self) -> None:
        """Forget the splines of all ``LARGE`` compliances if this is one; above ``SMALL``, its own with
        modes."""
        assert self.flexibility is not None
        with _KEEPING:
            if self._is_large:
                for other in _WITH_SPLINES:
                    other._cubics.clear()
                _WITH_SPLINES.add(self)
            elif self.flexibility.nbytes > SMALL:
                for key in self._cubics.keys() - {0, ("friction", 0)}:
                    self._cubics.pop(key)

    def cubic_of(self, moved: np.ndarray) -> np.ndarray:
        """Displacements (s,f,p,...) of the walls, in all or the first patterns, between stations
        (s-1,f,p,...,4), in the patterns of the parts of the faces that have a wall."""
        return cubic(self.travel, self._to_part(moved), self._breaks)

    def _to_part(self, moved: np.ndarray) -> np.ndarray:
        size = moved.shape[2]
        on_part = self.on_part[..., :size, :size].swapaxes(-1, -2)
        return np.einsum("sfab,sfb...->sfa...", on_part, moved)

    @cached_property
    def _breaks(self) -> list[tuple[int, ...]]:
        return [()] * self.rail.size if self.part is None else breaks(self.part)

    def _between_faces(self, table: np.ndarray) -> np.ndarray:
        once = self._is_large
        return between_faces(self.travel, table, self.rail, self.on_part, self._breaks, once)

    @cached_property
    def numbered(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (f,m) of the blocks of ``cubic`` between each face and the ``members`` of its rail, and
        whether a block is transposed."""
        return pairs.numbered(self.rail, self._is_large)

    @cached_property
    def members(self) -> np.ndarray:
        """Numbers (r,m) of the faces on each rail; -1 fills up."""
        return pairs.members(self.rail)

    @cached_property
    def shapes(self) -> np.ndarray:
        """Shapes (s-1,f,n,4,p) of all modes between stations, as in ``cubic``."""
        return self._of_modes(self.shape)[0]

    @cached_property
    def shapes_along(self) -> np.ndarray:
        """Shapes (s-1,f,n,4,d) of all modes along X, as in ``cubic_of_friction``."""
        return self._of_modes(residual.along(self))[0]

    @cached_property
    def _cubics(self) -> dict:
        return {}

    def residual(self, modes: int) -> np.ndarray:
        """Flexibility (s,f,m,p,p) m/N without the part of the first ``modes`` of each rail. Raises
        ValueError if this is not positive semidefinite: the modes then belong to another rail."""
        return residual.flexibility(self, modes)

    @property
    def _is_large(self) -> bool:
        return self.flexibility is not None and self.flexibility.nbytes > LARGE


_WITH_SPLINES: weakref.WeakSet[Splined] = weakref.WeakSet()  # those that are ``LARGE``
