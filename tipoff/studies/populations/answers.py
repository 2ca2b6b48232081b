"""The quantities that the studies of tolerances report: rates, lateral velocity, its direction, and
attitude.

    settled rates w_x, w_y, w_z and |w|      deg/s, inertial, in payload body axes
    lateral velocity  sqrt(v_y^2 + v_z^2)    mm/s, initial scene axes
    direction error   atan(v_lat / v_x)      deg
    attitude at exit  rotation vector        deg, about x, y and z
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np


class Left(Protocol):
    """Results of n cases, named as in ``lowfi.ensemble.columns.Columns``: rate (n,3) rad/s,
    lateral_velocity (n,) m/s, direction_error (n,) rad, exit_attitude (n,3) rad."""

    @property
    def rate(self) -> np.ndarray: ...
    @property
    def lateral_velocity(self) -> np.ndarray: ...
    @property
    def direction_error(self) -> np.ndarray: ...
    @property
    def exit_attitude(self) -> np.ndarray: ...


@dataclass(frozen=True, kw_only=True)
class Named:
    """The quantity of a row of a result: ``name``, ``label`` and ``unit`` as in ``Quantity``."""

    name: str
    label: str
    unit: str

    @property
    def title(self) -> str:
        """Label with unit."""
        return f"{self.label} ({self.unit})"


class Quantity(NamedTuple):
    """A quantity: ``name`` with its unit, as in result files; ``label`` and ``unit`` in figures and
    tables; ``of``, its values (n,) in that unit from columns."""

    name: str
    label: str
    unit: str
    of: Callable[[Any], np.ndarray]

    @property
    def named(self) -> dict[str, Any]:
        """The fields of ``Named``."""
        return {"name": self.name, "label": self.label, "unit": self.unit}

    @property
    def title(self) -> str:
        """Label with unit."""
        return f"{self.label} ({self.unit})"


def _rate(axis: int) -> Callable[[Left], np.ndarray]:
    return lambda found: np.degrees(found.rate[:, axis])


def _attitude(axis: int) -> Callable[[Left], np.ndarray]:
    return lambda found: np.degrees(found.exit_attitude[:, axis])


RATES = tuple(
    Quantity(f"rate_{axis}_deg_s", f"rate about {axis}", "deg/s", _rate(number))
    for number, axis in enumerate("xyz")
)
TOTAL_RATE = Quantity(
    "rate_deg_s",
    "total rate",
    "deg/s",
    lambda found: np.degrees(np.linalg.norm(found.rate, axis=1)),
)
VELOCITY = (
    Quantity(
        "lateral_velocity_mm_s",
        "lateral velocity",
        "mm/s",
        lambda found: 1e3 * found.lateral_velocity,
    ),
    Quantity(
        "direction_error_deg",
        "direction error of the velocity",
        "deg",
        lambda found: np.degrees(found.direction_error),
    ),
)
ATTITUDE = tuple(
    Quantity(f"attitude_{axis}_deg", f"attitude at exit about {axis}", "deg", _attitude(number))
    for number, axis in enumerate("xyz")
)
ALL = (*RATES, TOTAL_RATE, *VELOCITY, *ATTITUDE)
