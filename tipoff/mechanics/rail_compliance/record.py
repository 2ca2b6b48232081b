"""The record of a rail compliance: its fields, its file, the models that it allows."""

import hashlib
import threading
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from tipoff.files import DamageError, write_sealed
from tipoff.mechanics.rail_compliance import (
    array_checks,
    fewer,
    joint_terms,
    pairs,
    patterns,
    softened,
    stored,
)
from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST, JointTerms
from tipoff.mechanics.rail_compliance.nodal import Nodal
from tipoff.mechanics.rail_compliance.shown import Shown
from tipoff.mechanics.rail_compliance.splines import Splined

MODES = 20  # of each rail, stored with its compliance

_KEEPING, _FINDING = threading.Lock(), threading.Lock()
_KEPT_FACTORS = 4  # compliances at other factors that are kept in memory


@dataclass(frozen=True, eq=False, repr=False)
class RailCompliance(Shown, Splined):
    """Static compliance of the rails under the pads, with their lowest modes; rigid walls have no
    flexibility. Fields on its elements are in ``mechanics.rail_compliance.elements_stated``.

    Example:
        >>> rail = tipoff.compliance(tipoff.load("tiny"), 8e-3)
        >>> run = tipoff.run(tipoff.load("tiny"), compliance=rail, modes=0)
    """

    #: (s,) m, travel of the payload along X since ignition, evenly spaced.
    travel: np.ndarray
    #: (s,f,m,p,p) m/N between each face and the ``members`` of its rail (``pairs``), None for rigid
    #: walls.
    flexibility: np.ndarray | None
    #: (f,) number of the rail of each face.
    rail: np.ndarray
    #: (f,2) m, half the size of each face along xi and eta; negative if eta is opposite to the
    #: axis.
    half: np.ndarray
    #: (r,n) rad/s, frequencies of the lowest modes of each rail, ascending.
    frequency: np.ndarray
    #: (s,f,p,n) 1/kg^0.5, shapes W of the modes.
    shape: np.ndarray
    #: Digest of the rail and pads.
    made_for: str
    #: (s,f,2) middle and half length, in xi, of the part of each face that has a wall; None if every
    #: face is completely on its rail. Near an end it is the last part of the rail.
    part: np.ndarray | None = None
    #: (t,s,f,p) m, displacement away from the payload for a unit of each field of temperature.
    warm: np.ndarray | None = None
    #: Effect of a factor on the stiffness of the mounts, if it is known.
    joints: JointTerms | None = None
    #: (n,f,3) m, offset of walls that are not straight, from end to end
    #: (``mechanics.drawn_walls``).
    drawn: np.ndarray | None = None
    #: (s,f,m,d,d) m/N likewise, symmetric part of the displacement by friction along X, in the first d
    #: patterns, for a unit of pressure in each and a coefficient of 1. None for walls that friction
    #: does not move.
    dragged: np.ndarray | None = None
    #: (s,f,d,n) 1/kg^0.5, shapes V of the modes along X, in these patterns: the wall's displacement that
    #: friction drives. None: friction does not drive the modes.
    dragged_shape: np.ndarray | None = None
    #: Nodes of a long rail, from which its tables follow (``nodal``); they are in its file instead.
    nodes: Nodal | None = None
    #: Computes ``joints``, None for rigid mounts.
    find_joints: Callable[[], JointTerms | None] | None = None

    def __post_init__(self):
        """Arrays in the order of rows, as in a file: sums over an array in another order have other
        last bits. They are read only, because runs share a compliance and what follows from it."""
        ordered = {
            name: np.ascontiguousarray(value)
            for name, value in vars(self).items()
            if isinstance(value, np.ndarray)
        }
        joints = self.joints and JointTerms(*map(np.ascontiguousarray, self.joints))
        for name, value in (ordered | {"joints": joints}).items():
            object.__setattr__(self, name, value)
        for array in (*ordered.values(), *(joints or ())):
            array.flags.writeable = False

    @property
    def degree(self) -> int:
        """Degree of the patterns."""
        return patterns.degree_of(self.shape.shape[2])

    def at(self, factor: float) -> "RailCompliance":
        """This compliance at a ``factor`` on the stiffness of the mounts, which ``allows`` it."""
        if factor == 1.0:
            return self
        found = self._at_factors.get(factor)
        if found is None:
            found = self._at(factor)
            with _KEEPING:  # threads share a compliance
                while len(self._at_factors) >= _KEPT_FACTORS:
                    self._at_factors.pop(next(iter(self._at_factors)))
                self._at_factors[factor] = found
        return found

    def allows(self, factor: float) -> bool:
        """Whether the ``factor`` on the stiffness of the mounts is in the range of the joints; 1 always
        is."""
        return factor == 1.0 or (not self.is_of_fixed_joints and LEAST <= factor <= MOST)

    @property
    def is_of_fixed_joints(self) -> bool:
        """Whether the effect of a factor is not known."""
        return self.joints is None and self.find_joints is None

    @cached_property
    def _at_factors(self) -> dict[float, "RailCompliance"]:
        return {}

    def _at(self, factor: float) -> "RailCompliance":
        terms, flexibility, heat = self._terms, self.flexibility, self.warm
        assert terms is not None  # since ``allows``
        if flexibility is not None:
            flexibility = joint_terms.flexibility(terms, factor, flexibility, self.rail)
        if heat is not None:
            heat = joint_terms.warm(terms, factor, heat, self.rail)
        dragged = self.dragged
        if dragged is not None:
            dragged = joint_terms.dragged(terms, factor, dragged, self.rail)
        count = self.frequency.shape[1]
        frequency, shape, along = joint_terms.modes(terms, factor, count, self.rail)
        return replace(
            self,
            flexibility=flexibility,
            frequency=frequency,
            shape=shape,
            warm=heat,
            joints=None,
            find_joints=None,
            dragged=dragged,
            dragged_shape=along,
            nodes=None,
        )

    def finding(self, joints: Callable[[], JointTerms | None]) -> "RailCompliance":
        """This compliance, which calls ``joints`` at the first factor other than 1."""
        object.__setattr__(self, "find_joints", joints)
        return self

    @property
    def _terms(self) -> JointTerms | None:
        """``joints``, computed where they are not known."""
        with _FINDING:  # threads share a compliance
            return self._found_joints

    @cached_property
    def _found_joints(self) -> JointTerms | None:
        if self.joints is None and self.find_joints is not None:
            return self.find_joints()
        return self.joints

    def _flexibility(self) -> np.ndarray:
        """The flexibility; fails for rigid walls."""
        assert self.flexibility is not None
        return self.flexibility

    def __getstate__(self) -> dict:
        """The fields, for another process; derived arrays are computed again there."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @cached_property
    def hash(self) -> str:
        """Hexadecimal SHA-256 of all fields except ``mechanics.rail_compliance.elements_stated`` and
        ``joints``, which follow from the same rail."""
        digest = hashlib.sha256(self.made_for.encode())
        for array in (
            self.travel,
            self.flexibility,
            self.rail,
            self.half,
            self.frequency,
            self.shape,
            self.part,
            self.warm,
            self.drawn,
            self.dragged,
            self.dragged_shape,
        ):
            if array is not None:
                digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()

    def compliance(self) -> np.ndarray:
        """Mean displacement (s,f,f) in m/N of each face under a unit force spread evenly over each,
        both on the parts that have a wall."""
        mean = self.gram[..., :1, :]
        found = pairs.on_both_sides(mean, self._flexibility(), self.rail)
        return pairs.whole(found, self.rail)[:, :, 0, :, 0]

    @cached_property
    def gram(self) -> np.ndarray:
        """Means (s,f,p,p) of products of two patterns over the part of each face that has a wall."""
        found = self.on_part
        return found @ patterns.gram(self.degree) @ found.swapaxes(-1, -2)

    @cached_property
    def on_part(self) -> np.ndarray:
        """``on_part`` (s,f,p,p) of the parts of the faces that have a wall."""
        whole = np.tile([0.0, 1.0], (self.travel.size, self.rail.size, 1))
        part = whole if self.part is None else self.part
        return patterns.on_part(part, self.degree)

    def rigid(self) -> "RailCompliance":
        """These walls without flexibility: only their offsets, for springs."""
        return replace(
            self,
            flexibility=None,
            dragged=None,
            dragged_shape=None,
            nodes=None,
            element_size=None,
            uncertainty=None,
        )

    def moved(self, amounts: np.ndarray) -> np.ndarray:
        """Thermal offset T (s,f,p) m under ``amounts`` (t,) of the fields of temperature."""
        assert self.warm is not None
        return np.tensordot(amounts, self.warm, 1)

    def of_degree(self, degree: int) -> "RailCompliance":
        """The compliance for the patterns of a lower ``degree``: the same loads, and displacements
        projected on these patterns. Raises ValueError for a degree above its own."""
        if not patterns.LEAST_DEGREE <= degree <= self.degree:
            raise ValueError(f"degree: given {degree!r}, expected 1 to {self.degree}")
        if degree == self.degree:
            return self
        if degree not in self._of_degrees:
            self._of_degrees[degree] = self.of_first(patterns.count(degree))
        return self._of_degrees[degree]

    @cached_property
    def _of_degrees(self) -> dict[int, "RailCompliance"]:
        return {}

    def of_first(self, count: int) -> "RailCompliance":
        """The compliance for the first ``count`` patterns: loads in these alone, and displacements
        projected on them."""
        return replace(self, **fewer.of_first(self, count))

    @cached_property
    def softer(self) -> "RailCompliance | None":
        """The compliance that is larger by its own uncertainty; None if that is not known."""
        own = self.known()
        if own.uncertainty is None or own.frequency_uncertainty is None:
            return None
        return replace(own, **softened.softened(own))

    def restricted(self, count: int, coupled: bool = True) -> "RailCompliance":
        """The compliance of a simpler model: only the first ``count`` patterns of the same degree,
        and, unless ``coupled``, without the coupling between faces, without modes and without
        friction on the walls."""
        return replace(self, **fewer.restricted(self, count, coupled))

    def save(self, path: str | Path) -> None:
        """Write atomically, as arrays with their digest. The file holds ``joints`` and the uncertainty,
        which are computed first if they are not known.

        Args:
            path: file to write, ``.npz``.

        Example:
            >>> tipoff.compliance(tipoff.load("tiny"), 8e-3).save("rail.npz")
        """
        write_sealed(path, content(replace(self.known(), joints=self._terms)))

    @classmethod
    def load(cls, path: str | Path) -> "RailCompliance":
        """Read what ``save`` wrote.

        Args:
            path: file to read.

        Returns:
            RailCompliance: the compliance.

        Raises:
            FileNotFoundError: no such file.
            ValueError: a foreign or damaged file.

        Example:
            >>> tipoff.compliance(tipoff.load("tiny"), 8e-3).save("rail.npz")
            >>> rail = tipoff.RailCompliance.load("rail.npz")
        """
        try:
            compliance = cls(**stored.read(path))
            array_checks.require(compliance)
        except DamageError as fault:
            raise ValueError(f"{path}: not a file of rail compliance: it {fault.reason}") from fault
        except FileNotFoundError:
            raise
        except Exception as error:  # NumPy and zipfile raise many kinds on damaged bytes
            raise ValueError(f"{path}: not a file of rail compliance ({error})") from error
        return compliance


def content(compliance: RailCompliance) -> bytes:
    """The file of what is known of a compliance, without its digest."""
    known = compliance.__getstate__()
    known.pop("find_joints")
    known.pop("find_uncertainty")
    return stored.content(known)
