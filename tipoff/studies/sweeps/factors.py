"""The errors that section 3 of the paper varies in size and direction, one at a time, and the rates of a
free payload by each.

A free payload of inertia I leaves with w = I^-1 L, where L = J (r x f) is the moment impulse of
``scenes.moments``. On the reference scene that is 26 deg/s per millimetre of arm. Gyroscopic
moments are left out: they are quadratic in the rates.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.lowfi.ensemble.rows import Listed, numbers
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust
from tipoff.scenes import halving, launch, moments, polar, scene_model, uncertainty
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty


class Factor(NamedTuple):
    """A swept error: ``name``, ``label`` for a reader, dotted ``table`` of its size ``axial`` and
    direction ``radial``, its ``unit``, the size of that unit in SI, and the ``largest`` swept size in
    ``unit``."""

    name: str
    label: str
    table: str
    unit: str
    si: float
    largest: float = 1.0

    @property
    def sizes(self) -> np.ndarray:
        """The swept sizes in ``unit``."""
        return self.largest * SHARES

    def rows(self, sizes: np.ndarray, angles: np.ndarray) -> list[dict[str, float]]:
        """Overrides (SI) of every size (in ``unit``) at every angle (rad), sizes outermost."""
        return [
            {f"{self.table}.axial": float(size) * self.si, f"{self.table}.radial": float(angle)}
            for size in sizes
            for angle in angles
        ]


FACTORS = (
    Factor(
        "misalignment", "thrust misalignment", "thrust_offset.misalignment", "deg", np.pi / 180.0
    ),
    Factor("thrust_eccentricity", "thrust eccentricity", "thrust_offset.eccentricity", "mm", 1e-3),
    Factor("mass_eccentricity", "mass eccentricity", "mass_offset.eccentricity", "mm", 1e-3),
)
SHARES = np.arange(1, 11) / 10.0  # of the largest size
_NEARLY_ALL = 0.999  # of the sizes of a file of errors are swept


def of_file(vary: str, scene: Scene) -> tuple[Factor, ...]:
    """The errors that a file of errors varies, each up to the size that 99.9 % of its draws stay below, in
    two digits. Raises SceneError with every fault, also where the file varies none of them."""
    errors = uncertainty.load(vary, scene)
    sizes = [_largest(errors, factor.table) / factor.si for factor in FACTORS]
    found = tuple(
        factor._replace(largest=float(f"{size:.2g}"))
        for factor, size in zip(FACTORS, sizes)
        if size > 0.0
    )
    if not found:
        tables = ", ".join(factor.table for factor in FACTORS)
        given = ", ".join(errors.vary)
        raise SceneError([Fault(vary, "vary, factor", given, f"a size above zero of {tables}")])
    return found


def held(vary: str, scene: Scene) -> dict[str, str]:
    """The other tolerances of a file of errors with their sizes (``scenes.halving``), by name. Their values are
    those of the scene in each case of a sweep."""
    swept = {factor.table for factor in FACTORS}
    sizes = halving.sizes(uncertainty.load(vary, scene))
    return {name: size for name, size in sizes.items() if name not in swept}


def _largest(errors: Uncertainty, table: str) -> float:
    """The size (SI) of the error ``table`` that nearly all draws stay below; zero if it does not vary."""
    if (size := errors.vary.get(f"{table}.axial")) is not None:
        scale = errors.factors.get(f"{table}.axial", 1.0)
        return abs(scale) * float(size.ppf(np.array(_NEARLY_ALL)))
    beyond = 0.5 * (1.0 - _NEARLY_ALL)
    items = [item for axis in polar.COMPONENTS if (item := errors.vary.get(f"{table}.{axis}"))]
    ends = [abs(item.ppf(np.array([beyond, 1.0 - beyond]))).max() for item in items]
    return float(np.hypot.reduce(ends)) if ends else 0.0


def angles(count: int) -> np.ndarray:
    """``count`` directions (rad) around the axis from the zero of the scene's angle, (count,)."""
    return np.arange(count) * (2.0 * np.pi / count)


def alone(scene: Scene) -> Scene:
    """The scene with none of these errors."""
    return scene.replace({"thrust_offset": None, "mass_offset": None})


def cases(swept: Sequence[Factor], directions: np.ndarray) -> Listed:
    """All cases of all factors as one list, in order, sizes outermost."""
    return Listed([row for factor in swept for row in factor.rows(factor.sizes, directions)])


def free_rates(
    scene: Scene, rows: list[dict[str, float]], until: float | None = None
) -> np.ndarray:
    """Rates (n,3), rad/s, of a free payload of ``scene`` with ``rows`` of overrides of a factor, by
    the impulse ``until`` a time (s); None: the whole."""
    table = Listed(rows)
    inputs = dict(zip(table.keys, numbers(table.keys, rows).T))
    impulse = float(
        thrust.impulse(
            ends.over_time(launch.of_scene(scene)), scene.time_limit if until is None else until
        )
    )
    return (
        moments.moment_impulses(scene, inputs, impulse)
        @ scene_model.build(scene).payload.inverse_inertia.T
    )
