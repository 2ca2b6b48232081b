"""The sheet of a log: a small TOML file beside the CSV file. It states the columns and the
uncertainty of the sensor. A sheet with the table ``[launch]`` is of a launch from rest on a rail, one with
``[windows]`` of a drop test::

    file = "drop1.csv"
    channel_class = 60                         # CFC of SAE J211 and ISO 6487; absent: not filtered
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]   # columns: the sensor's axes in payload body axes

    [columns]  [units]                         # names in the CSV and their units
    [gyro]                                     # raw = (1 + scale_error) (1 + misalignment) w + bias
                                               #       + g_sensitivity f + temperature
    [gyro.uncertainty]                         # standard uncertainties of these (GUM)
    [accelerometer]  [events]  [windows]       # of a drop test
    [accelerometer]  [launch]                  # of a launch

Quantities have units, as in a scene. A key that is misspelt, missing or of another dimension is a fault.
"""

from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from tipoff.faults import SceneError
from tipoff.formats.logs.sensor_log import zero_and_one
from tipoff.scenes import reading
from tipoff.scenes.faults import faults_of
from tipoff.scenes.table import Table
from tipoff.scenes.units import (
    Acceleration,
    NonNegativeNumber,
    NonNegativeTime,
    Number,
    PositiveLength,
    PositiveTime,
    Rate,
    Time,
    quantity,
)
from tipoff.units import parse, to_si

# sheets of the simulated logs that come with the package
SAMPLES = sorted((Path(__file__).resolve().parent / "logs").glob("*.toml"))
_Kind = TypeVar("_Kind")
_Triple = tuple[_Kind, _Kind, _Kind]
_Matrix = tuple[_Triple[_Kind], _Triple[_Kind], _Triple[_Kind]]
_SKEW = 1e-3  # tolerance of typed direction cosines that must be orthonormal


def _in(unit: str, **bounds: float) -> tuple:
    """The type that ``quantity`` makes of a float."""
    return quantity(unit, **bounds).__metadata__


_FASTEST = 1e6  # rad/s, above the range of any gyro
NonNegativeRate = Annotated[float, *_in("rad/s", ge=0.0, le=_FASTEST)]
PositiveRate = Annotated[float, *_in("rad/s", gt=0.0, le=_FASTEST)]
PositiveAcceleration = Annotated[float, *_in("m/s**2", gt=0.0)]
# bounds of errors of a real sensor: within them its matrix has an inverse
ScaleError = Annotated[float, *_in("dimensionless", ge=-0.5, le=0.5)]
Misalignment = Annotated[float, *_in("rad", ge=-0.3, le=0.3)]
GSensitivity = Annotated[float, *_in("rad*s/m")]
GSensitivityError = Annotated[float, *_in("rad*s/m", ge=0.0)]
Drift = Annotated[float, *_in("rad/s/K")]
DriftError = Annotated[float, *_in("rad/s/K", ge=0.0)]


def _unit_of(si: str) -> AfterValidator:
    def check(text: str) -> str:
        zero_and_one(text, si)
        return text

    return AfterValidator(check)


def _temperature(value: Any, info: ValidationInfo) -> float:
    """A temperature on the absolute scale, so that degC has the correct zero."""
    bare = bool(info.context and info.context.get("bare_numbers_are_si"))
    return to_si(value, "K", absolute=True) if isinstance(value, str) else parse(value, "K", bare)


class Columns(Table):
    """Names of columns in the CSV file, with or without their units. An absent ``time`` is the only
    column whose name says that it is a time."""

    time: str | None = None
    rate: _Triple[str]
    acceleration: _Triple[str] | None = None
    temperature: str | None = None

    def names(self) -> dict[str, tuple[str, ...]]:
        """The names by quantity, none of an absent one."""
        return {
            "time": (self.time,) if self.time else (),
            "rate": self.rate,
            "acceleration": self.acceleration or (),
            "temperature": (self.temperature,) if self.temperature else (),
        }


class Units(Table):
    """Units of the columns. They may be absent if the header of the CSV file states them. A unit of
    counts has a number, such as "0.0048 m/s**2"."""

    time: Annotated[str, _unit_of("s")] | None = None
    rate: Annotated[str, _unit_of("rad/s")] | None = None
    acceleration: Annotated[str, _unit_of("m/s**2")] | None = None
    temperature: Annotated[str, _unit_of("K")] | None = None


class GyroUncertainty(Table):
    """Standard uncertainties: ``bias_instability`` (rad/s) is B of IEEE 952, scale and
    ``misalignment`` (rad) are those of one entry after calibration and mounting, ``g_sensitivity``
    in rad s/m, ``temperature`` in rad/s/K. White noise is in the log."""

    bias_instability: NonNegativeRate
    scale: NonNegativeNumber
    misalignment: Annotated[float, *_in("rad", ge=0.0)]
    g_sensitivity: GSensitivityError
    temperature: DriftError = 0.0


class Gyro(Table):
    """Calibration of the gyros in sensor axes. An absent value is zero; range and resolution have
    no default."""

    range: PositiveRate
    resolution: NonNegativeRate
    uncertainty: GyroUncertainty
    bias: _Triple[Rate] = (0.0,) * 3
    scale_error: _Triple[ScaleError] = (0.0,) * 3
    misalignment: _Matrix[Misalignment] = ((0.0,) * 3,) * 3
    g_sensitivity: _Matrix[GSensitivity] = ((0.0,) * 3,) * 3
    temperature: _Triple[Drift] = (0.0,) * 3
    reference_temperature: Annotated[float, BeforeValidator(_temperature)] = 293.15


class Accelerometer(Table):
    """Calibration of the accelerometers in sensor axes. ``scale_uncertainty``: standard uncertainty of
    the scale, which the speed of a launch has too."""

    range: PositiveAcceleration
    scale_uncertainty: NonNegativeNumber | None = None
    bias: _Triple[Acceleration] = (0.0,) * 3
    scale_error: _Triple[ScaleError] = (0.0,) * 3


class Triggers(Table):
    """Instants (s of the log) from another source, such as a trigger channel, in place of those
    found in the accelerations."""

    release: Time
    ignition: Time


class Windows(Table):
    """``exit`` (s after ignition) of the payload from its rail with its standard uncertainty;
    ``rest`` (s) before release during which no rate may exceed ``rest_rate`` (rad/s);
    ``after_release`` (s) until the platform is calm; length of the ``settled`` window (s)."""

    exit: PositiveTime
    exit_uncertainty: PositiveTime = 1e-3
    rest: PositiveTime = 1.0
    rest_rate: PositiveRate = np.radians(0.5)
    after_release: NonNegativeTime = 0.05
    settled: PositiveTime = 0.1


class Launch(Table):
    """A launch: time ``at_rest`` (s) before the start; the ``exit``, at the travel of the scene ("way"), at the
    end of the noise of contact ("contact"), or between two instants (s of the log); standard uncertainty of
    the travel (m); time ``after`` the exit (s) whose rates are extrapolated to it; standard uncertainty of
    the ``delay`` between rates and accelerations (s)."""

    travel_uncertainty: PositiveLength
    at_rest: PositiveTime = 0.5
    exit: Literal["way", "contact"] | tuple[Time, Time] = "way"
    after: PositiveTime = 0.05
    delay_uncertainty: NonNegativeTime = 1e-3


class SensorSheet(Table):
    """What every sheet has: columns, units, calibration. Without a ``channel_class`` nothing is
    filtered."""

    file: str
    channel_class: Literal[60, 180, 600, 1000] | None = None
    axes: _Matrix[Number]
    columns: Columns
    units: Units = Units()
    gyro: Gyro
    accelerometer: Accelerometer | None = None
    description: str = ""
    simulated: bool = False
    scene: str | None = None

    def _missing(self) -> list[str]:
        """What this kind of sheet lacks, in words."""
        return []

    @model_validator(mode="after")
    def _whole(self):
        wrong = [
            f"{name} in [columns] too, not only in [units]"
            for name in ("acceleration", "temperature")
            if getattr(self.columns, name) is None and getattr(self.units, name) is not None
        ]
        wrong += self._missing()
        if self.columns.acceleration is not None and self.accelerometer is None:
            wrong.append("[accelerometer] with the range of the accelerations")
        axes = np.array(self.axes)
        if np.abs(axes.T @ axes - np.eye(3)).max() > _SKEW:
            wrong.append("axes of unit length, perpendicular to each other")
        elif np.linalg.det(axes) < 0.0:
            wrong.append("right-handed axes")
        if wrong:
            raise ValueError("; ".join(wrong))
        return self

    @property
    def mounting(self) -> np.ndarray:
        """Rotation (3,3) from sensor to body axes: the nearest one to ``axes``, which have few
        digits."""
        left, _, right = np.linalg.svd(np.array(self.axes))
        return left @ right


class Sheet(SensorSheet):
    """The sheet of a drop test."""

    windows: Windows
    events: Triggers | None = None

    def _missing(self) -> list[str]:
        if self.columns.acceleration is None and self.events is None:
            words = "accelerations, in which release and ignition show, or [events] that says when they were"
            return [words]
        return []


class LaunchSheet(SensorSheet):
    """The sheet of a launch."""

    launch: Launch

    def _missing(self) -> list[str]:
        if self.columns.acceleration is None:
            return ["accelerations, whose integral is the speed along the rail"]
        if self.accelerometer is not None and self.accelerometer.scale_uncertainty is None:
            return [
                "accelerometer.scale_uncertainty, such as 0.01, which the speed of a launch has too"
            ]
        return []


def load(path: str | Path) -> Sheet | LaunchSheet:
    """Read a sheet. Raises SceneError listing every fault."""
    raw = reading.toml(Path(path), str(path))
    try:
        return (LaunchSheet if "launch" in raw else Sheet).model_validate(raw, context={})
    except ValidationError as error:
        raise SceneError(faults_of(error, str(path))) from error
