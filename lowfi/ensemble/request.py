"""Definition of an ensemble: the scene, the source of its cases, and all other inputs of its
numbers."""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from tipoff import sources
from tipoff.files import content_hash
from tipoff.lowfi.ensemble import store as stores
from tipoff.lowfi.ensemble.batch import Case, Family
from tipoff.lowfi.ensemble.threads import completed
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene

_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")  # may change the last bits of a result


class Ensemble(NamedTuple):
    """A scene and its cases."""

    scene: Scene
    source: Any  # of the cases (``lowfi.ensemble.rows``, ``lowfi.ensemble.table``)
    calibration: Calibration | None  # constants of springs, and changes of the values in rows
    numerics: Numerics
    compliance: RailCompliance | None = None  # None for contact springs on rigid walls
    widening: float = 0.0  # m, added to every clearance of a case
    modes_why: str = ""  # reason for the number of modes, if a pilot chose it

    def family(self) -> Family:
        """The Family that runs its cases."""
        return Family(self.scene, self.calibration, self.numerics, self.compliance, self.widening)

    def identity(self) -> dict:
        """Everything that determines the numbers, as JSON."""
        return {
            "scene": self.scene.hash,
            "cases": self.source.identity,
            "numerics": self.numerics.as_dict(),
            "calibration": self.calibration.applied if self.calibration else {},
            "walls": self.compliance.hash if self.compliance else "",
            "widening": self.widening,
            "chunk": stores.CHUNK,
        } | code()

    @property
    def key(self) -> str:
        """Hexadecimal digest of the identity."""
        return content_hash(self.identity())

    def store(self, path: str | Path) -> stores.Store:
        """The store of this ensemble at ``path``, created if it does not exist. Raises
        StoreError."""
        rerun = (
            "case n has the inputs stored under n, and is drawn again from seed and n alone: "
            "tipoff ensemble ... --case n"
        )
        return stores.Store(
            path,
            self.source.asked,
            self.source.keys,
            self.identity(),
            {"scene": self.scene.resolved(), "rerun": rerun}
            | ({"modes_why": self.modes_why} if self.modes_why else {}),
        )

    def case(self, number: int) -> tuple[Mapping[str, Any], Case]:
        """Inputs and result of one case, run alone, with the same bits."""
        (row,) = self.source.rows(number, number + 1)
        return row, self._run(row)

    def nominal(self) -> Case:
        """Result of the scene itself."""
        return self._run({})

    def _run(self, row: Mapping[str, Any]) -> Case:
        ((found,),) = completed(self.family(), [[row]], workers=1)
        return found


@lru_cache  # the sources do not change while the program runs
def code() -> dict:
    """Digest of the sources and versions of the libraries that determine the numbers."""
    return {
        "code": sources.digest("tipoff.lowfi", without=sources.READERS),
        "versions": {name: sources.version(name) for name in _LIBRARIES},
    }
