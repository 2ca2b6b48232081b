"""Calibrated surrogate constants: values with their evidence, as a TOML file. Data only; the fit
itself is in ``calibrate``."""

import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from tipoff import toml
from tipoff.files import DamageError, is_sealed, read_input, require_whole, sealed
from tipoff.scenes.scene import Scene

# Clearance and friction belong to both surrogates.
_OF_SPRINGS = {
    f"contact.{name}"
    for name in ("stiffness", "exponent", "damping", "damping_depth", "dissipation")
}
_OF_COMPLIANT_CONTACT = {"contact.interface_stiffness", "rail.mount_stiffness.factor"}


def _has(scene: Scene, key: str) -> bool:
    """Whether no table on the way to the dotted ``key`` is absent. One that does not exist is left
    to the scene to refuse."""
    table: object = scene
    for name in key.split(".")[:-1]:
        table = getattr(table, name, "unknown")
    return table is not None


@dataclass(frozen=True, eq=False)
class Calibration:
    """Constants found for a scene.

    ``constants`` are dotted overrides in SI, applied to a scene by ``apply``. ``parameters`` name
    the fitted coordinates (with ``values``, their 95 % ``intervals``, infinite where the curves do
    not determine them and without model error, ``lower``, ``upper`` bounds and ``justification``);
    ``information`` is the matrix (p,p) of the scaled parameters; ``weak_directions`` describe what
    the curves do not determine; ``residuals`` are per condition.
    """

    constants: dict[str, float]
    parameters: list[str]
    values: list[float]
    units: list[str]
    lower: list[float]
    upper: list[float]
    justification: list[str]
    information: np.ndarray
    weak_directions: list[str]
    residuals: dict[str, dict[str, float]]
    conditions: list[str]
    objective: float
    provenance: dict[str, str] = field(default_factory=dict)
    intervals: list[list[float]] = field(default_factory=list)

    def apply(self, scene: Scene) -> Scene:
        """``scene`` with the calibrated constants; constants of an effect the scene lacks are left
        out."""
        return scene.replace(
            {key: value for key, value in self.constants.items() if _has(scene, key)}
        )

    @property
    def is_of_springs(self) -> bool:
        """Whether some of these constants belong to contact springs alone."""
        return not _OF_SPRINGS.isdisjoint(self.constants)

    @property
    def is_of_compliant_contact(self) -> bool:
        """Whether some of these constants belong to compliant contact alone."""
        return not _OF_COMPLIANT_CONTACT.isdisjoint(self.constants)

    def save(self, path: str | Path) -> None:
        """Write TOML with its digest, atomically. Raises ValueError for a NaN (an interval without
        an end is inf)."""
        tables = asdict(self) | {"information": np.asarray(self.information).tolist()}
        with sealed(path) as temporary:
            temporary.write_text(toml.dumps(tables), encoding="utf-8", newline="\n")

    @classmethod
    def load(cls, path: str | Path) -> "Calibration":
        """Read what ``save`` or a user wrote; the file of a user needs no digest. Raises
        FileNotFoundError, or ValueError for a foreign or damaged file."""
        try:
            if is_sealed(path):
                require_whole(path)
            data = tomllib.loads(read_input(path).decode("utf-8-sig"))
            return cls(**data | {"information": np.array(data["information"])})
        except DamageError as fault:
            raise ValueError(
                f"{path} {fault.reason}: make it again, or remove the line '# sha-256 ...' if you "
                f"edited the file on "
                "purpose"
            ) from fault
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise ValueError(f"{path}: not a calibration file ({error})") from error
