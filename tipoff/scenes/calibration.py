"""Calibrated surrogate constants: values with their evidence, as a TOML file. Only data; the fit is
in ``calibrate``."""

import tomllib
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from tipoff import toml
from tipoff.cards import Carded
from tipoff.files import (
    FORMAT,
    FORMAT_KEY,
    DamageError,
    is_sealed,
    read_input,
    require_format,
    require_whole,
    sealed,
)
from tipoff.scenes import changes as added
from tipoff.scenes.scene import Scene

# Clearance and friction belong to both surrogates.
_OF_SPRINGS = {
    f"contact.{name}"
    for name in ("stiffness", "exponent", "damping", "damping_depth", "dissipation")
}
_OF_COMPLIANT_CONTACT = {"contact.interface_stiffness", "rail.mount_stiffness.factor"}


def _has(scene: Scene, key: str) -> bool:
    """Whether no table on the way to the dotted ``key`` is absent. An unknown table is left to the
    scene, which refuses it."""
    table: object = scene
    for name in key.split(".")[:-1]:
        table = getattr(table, name, "unknown")
    return table is not None


@dataclass(frozen=True, eq=False)
class Calibration(Carded):
    """Constants found for a scene, with their evidence.

    Example:
        >>> found = tipoff.Calibration.load("calibration.toml")  # written by tipoff calibrate
        >>> run = tipoff.run(tipoff.load("tiny"), "springs", calibration=found)
    """

    #: Dotted overrides in SI.
    constants: dict[str, float]
    #: Names of the p fitted parameters.
    parameters: list[str]
    values: list[float]
    units: list[str]
    #: Bounds of the fit.
    lower: list[float]
    upper: list[float]
    #: Reasons for the bounds.
    justification: list[str]
    #: Information matrix (p,p) of the scaled parameters.
    information: np.ndarray
    #: Sentences on what the curves do not determine.
    weak_directions: list[str]
    #: By condition.
    residuals: dict[str, dict[str, float]]
    #: Names of the fitted conditions.
    conditions: list[str]
    objective: float
    provenance: dict[str, str] = field(default_factory=dict)
    #: 95 % intervals without model error; infinite if the curves do not determine the value.
    intervals: list[list[float]] = field(default_factory=list)
    #: Amounts in SI that are added to the values of a scene (``scenes.changes``).
    changes: dict[str, float] = field(default_factory=dict)
    #: 95 % intervals with model error, of a fit on compliant contact.
    with_model_error: list[list[float]] = field(default_factory=list)
    #: Whether the curves exclude the scene's values, as text; empty if that is not judged.
    verdict: str = ""
    #: Values of the fit if ``values`` are the scene's, which are kept; else empty.
    fitted: list[float] = field(default_factory=list)

    @property
    def estimates(self) -> list[float]:
        """The values to which the intervals belong."""
        return self.fitted or self.values

    def __repr__(self) -> str:
        fitted = ", ".join(
            f"{name} {value:.4g}{'' if unit == '1' else f' {unit}'}"
            for name, value, unit in zip(self.parameters, self.values, self.units)
        )
        return f"Calibration({fitted}; fitted to {', '.join(self.conditions)})"

    def _facts(self) -> dict[str, str]:
        found = {}
        ends: list[list[float] | None] = [*self.intervals]
        ends += [None] * (len(self.parameters) - len(ends))
        columns = zip(self.parameters, self.values, self.estimates, self.units, ends)
        for name, value, estimate, unit, interval in columns:
            between = "" if interval is None else f" ({interval[0]:.4g} to {interval[1]:.4g})"
            kept = "" if value == estimate else f", kept at {value:.4g}"
            found[name] = f"{estimate:.4g}{between}{'' if unit == '1' else f' {unit}'}{kept}"
        found["fitted to"] = ", ".join(self.conditions)
        if self.weak_directions:
            found["weak"] = "; ".join(self.weak_directions)
        return found | ({"verdict": self.verdict} if self.verdict else {})

    def apply(self, scene: Scene) -> Scene:
        """A scene with the calibrated constants and changes.

        Args:
            scene: a scene, or one of its conditions. Constants of absent effects are left out.

        Returns:
            Scene: the new scene.

        Raises:
            SceneError: a scene that cannot have these values.

        Example:
            >>> scene = tipoff.load("tiny")
            >>> found = tipoff.Calibration.load("calibration.toml")
            >>> found.apply(scene).contact.stiffness == found.constants["contact.stiffness"]
            True
        """
        fitted = {key: value for key, value in self.constants.items() if _has(scene, key)}
        return scene.replace(fitted | added.overrides(scene, self.changes))

    def split(self, scene: Scene) -> "tuple[Scene, Calibration | None]":
        """``scene`` with the calibrated constants, which a case of an ensemble may replace, and the
        changes that are added to each case, None without changes."""
        if not self.changes:
            return self.apply(scene), None
        return replace(self, changes={}).apply(scene), replace(self, constants={})

    @property
    def applied(self) -> dict:
        """Inputs of ``apply`` as JSON; only the constants if there are no changes."""
        return self.constants | ({"changes": self.changes} if self.changes else {})

    @property
    def is_of_springs(self) -> bool:
        """Whether some of these constants belong only to contact springs."""
        return not _OF_SPRINGS.isdisjoint(self.constants)

    @property
    def is_of_compliant_contact(self) -> bool:
        """Whether some of these constants belong only to compliant contact."""
        return not _OF_COMPLIANT_CONTACT.isdisjoint(self.constants)

    def save(self, path: str | Path) -> None:
        """Write TOML with its digest, atomically.

        Args:
            path: file to write.

        Raises:
            ValueError: a NaN (an interval without an end is inf).

        Example:
            >>> tipoff.Calibration.load("calibration.toml").save("again.toml")
        """
        tables = (
            {FORMAT_KEY: FORMAT}
            | asdict(self)
            | {"information": np.asarray(self.information).tolist()}
        )
        with sealed(path) as temporary:
            temporary.write_text(toml.dumps(tables), encoding="utf-8", newline="\n")

    @classmethod
    def load(cls, path: str | Path) -> "Calibration":
        """Read what ``save`` or a user wrote; the file of a user needs no digest.

        Args:
            path: file to read, such as ``calibration.toml`` of ``tipoff calibrate``.

        Returns:
            Calibration: the constants.

        Raises:
            FileNotFoundError: no such file.
            ValueError: a foreign or damaged file.

        Example:
            >>> tipoff.Calibration.load("calibration.toml").conditions
            ['phi15']
        """
        try:
            if is_sealed(path):
                require_whole(path)
            data = tomllib.loads(read_input(path).decode("utf-8-sig"))
            require_format(path, data.pop(FORMAT_KEY, None))
            return cls(**data | {"information": np.array(data["information"])})
        except DamageError as fault:
            raise ValueError(
                f"{path} {fault.reason}: make it again, or remove the line '# sha-256 ...' if you "
                f"edited the file on "
                "purpose"
            ) from fault
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise ValueError(f"{path}: not a calibration file ({error})") from error
