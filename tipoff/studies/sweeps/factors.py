"""The errors that section 3 of the paper varies in size and direction, one at a time, and the rates of a
free payload by each.

A free payload of inertia I leaves with w = I^-1 L, where L = J (r x f) is the moment impulse of
``scenes.moments``. On the reference scene that is 26 deg/s per millimetre of arm. Gyroscopic
moments are left out: they are quadratic in the rates.
"""

from typing import NamedTuple

import numpy as np

from tipoff.lowfi.ensemble.rows import Listed, numbers
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust
from tipoff.scenes import launch, moments, scene_model
from tipoff.scenes.scene import Scene


class Factor(NamedTuple):
    """A swept error: ``name``, ``label`` for a reader, dotted ``table`` of its size ``axial`` and
    direction ``radial``, its ``unit``, and the size of that unit in SI."""

    name: str
    label: str
    table: str
    unit: str
    si: float

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
SIZES = np.arange(1, 11) / 10.0  # deg or mm


def angles(count: int) -> np.ndarray:
    """``count`` directions (rad) around the axis from the zero of the scene's angle, (count,)."""
    return np.arange(count) * (2.0 * np.pi / count)


def alone(scene: Scene) -> Scene:
    """The scene with none of these errors."""
    return scene.replace({"thrust_offset": None, "mass_offset": None})


def cases(directions: np.ndarray) -> Listed:
    """All cases of all factors as one list, in order, sizes outermost."""
    return Listed([row for factor in FACTORS for row in factor.rows(SIZES, directions)])


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
