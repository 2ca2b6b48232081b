"""``[thrust] kind = "measured"``: a thrust over time from a file or from points, used point by point or
through its least-squares Gaussian fit."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from tipoff.formats.thrusts.record import Choice
from tipoff.mechanics.laws.thrust import Curve, Pulses, Thrust
from tipoff.scenes.effects import load_cell
from tipoff.scenes.effects.load_cell import Levels
from tipoff.scenes.effects.measured import (
    FIT_IMPULSE,
    GaussianFit,
    MeasuredCurve,
    curve_of_points,
    fit_gaussian,
    from_ignition,
    read_record,
    without_baseline,
)
from tipoff.scenes.effects.timed import TimedTable
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import below
from tipoff.scenes.table import is_absent, is_one, is_zero, limited
from tipoff.scenes.units import Force, NonNegativeNumber, PositiveNumber, Time

# keys whose effect is in the points
_READ = {*Choice._fields, "ignition", "remove_offset", "factor"}


class MeasuredTable(TimedTable):
    """``[thrust] kind = "measured"``: a file with a thrust over time, or its points; ``use`` the curve
    itself or its Gaussian fit."""

    #: A measured curve.
    kind: Literal["measured"]
    #: Name of the motor in a file with several, or its maker and name.
    motor: str | None = Field(None, exclude_if=is_absent)
    #: Name of the column of times, if the header has several; the number of the column, from 1 on,
    #: in a table without a header.
    time_column: str | None = Field(None, exclude_if=is_absent)
    #: Name or number of the column of thrusts, as for time_column.
    thrust_column: str | None = Field(None, exclude_if=is_absent)
    #: Unit of the times, if the table does not state it.
    time_unit: str | None = Field(None, exclude_if=is_absent)
    #: Unit of the thrusts, if the table does not state it.
    thrust_unit: str | None = Field(None, exclude_if=is_absent)
    #: Instant in the file at which the scene begins; earlier points are left out.
    ignition: Time | None = Field(None, exclude_if=is_absent)
    #: File with times and thrusts, as in a CSV with the header time_s,force_N; or a motor in a .eng
    #: or .rse file; relative to the scene file. Either this or points.
    file: str | None = None
    #: Times and thrusts, in time_unit and thrust_unit; either these or file.
    points: Annotated[tuple[tuple[float, float], ...], limited] | None = Field(
        None, exclude_if=is_absent
    )
    #: "curve": the points act; "fit": their Gaussian fit acts.
    use: Literal["curve", "fit"] = "curve"
    #: Largest relative error of the impulse of the fit, with use = "fit".
    fit_impulse_tolerance: NonNegativeNumber = FIT_IMPULSE
    #: Readings of the load cell without thrust, at the first and at the last point. The straight
    #: line between them is subtracted.
    baseline: tuple[Force, Force] | None = Field(None, exclude_if=is_absent)
    #: Subtracts the readings that are found before ignition and after burn-out, and sets the points
    #: before ignition to zero.
    remove_offset: bool = Field(False, exclude_if=is_zero)
    #: Multiplies the forces; studies of uncertainty vary it.
    factor: PositiveNumber = Field(1.0, exclude_if=is_one)
    _curve: MeasuredCurve = PrivateAttr()
    _levels: Levels = PrivateAttr()
    _words: str = PrivateAttr()
    _calm: str = PrivateAttr()

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str | None, info: ValidationInfo):
        if file is not None and all(key in info.data for key in (*Choice._fields, "ignition")):
            choice = Choice(*(info.data[key] for key in Choice._fields))
            ignition = info.data["ignition"]
            curve, _ = read_record(file, choice, ignition is not None)
            from_ignition(curve, ignition)
        return file

    @model_validator(mode="after")
    def _usable(self):
        choice = Choice(*(getattr(self, key) for key in Choice._fields))
        curve, self._words = self._read(choice, self.ignition is not None)
        before, after = load_cell.levels(curve)
        if self.remove_offset and self.baseline is not None:
            raise within("remove_offset", "baseline too", "one or the other")
        if self.remove_offset and before is None:
            raise within(
                "remove_offset",
                "true, for a record that begins with thrust",
                f"at least {load_cell.FEWEST} points before ignition",
            )
        self._calm = load_cell.words(before, self.remove_offset)
        if self.remove_offset:
            curve = load_cell.without_offset(curve, before, after)
        curve = without_baseline(curve, self.baseline)
        self._levels = load_cell.levels(curve)
        time, force = from_ignition(curve, self.ignition)
        self._curve = MeasuredCurve(time, self.factor * force)
        if self.use == "fit":
            fit = fit_gaussian(self._curve)
            if below(self.fit_impulse_tolerance, abs(fit.impulse_error)):
                raise within(
                    "use",
                    f"'fit', whose impulse after ignition differs by {100.0 * fit.impulse_error:+.3g} % from "
                    f"the {fit.curve_impulse:.5g} N s of the curve, relative residual "
                    f"{100.0 * fit.relative_residual:.3g} %",
                    f"a difference of at most {100.0 * self.fit_impulse_tolerance:g} %: "
                    f'use = "curve", or a larger thrust.fit_impulse_tolerance',
                )
        return self

    def _read(self, choice: Choice, may_begin_early: bool) -> tuple[MeasuredCurve, str]:
        """The curve of the file or of the points, and what was read in words."""
        if self.file is not None and self.points is None:
            return read_record(self.file, choice, may_begin_early)
        if self.points is None:
            raise within("file", "nothing", "a file, or points")
        if self.file is not None:
            raise within("points", "points and a file", "one or the other")
        try:
            curve = curve_of_points(self.points, choice, may_begin_early)
            from_ignition(curve, self.ignition)
            return curve, ""
        except ValueError as fault:
            raise within("points", f"{len(self.points)} points", str(fault)) from fault

    def fit(self) -> GaussianFit | None:
        """Least-squares Gaussian of the curve, with residual and impulses; None if there is
        none."""
        try:
            return fit_gaussian(self._curve)
        except ValueError:
            return None

    def curve(self) -> MeasuredCurve:
        """Measured times (s) and forces (N) without the baseline, times the factor."""
        return self._curve

    def levels(self) -> Levels:
        """Readings before ignition and after burn-out of the whole file, without the baseline."""
        return self._levels

    def contents(self) -> tuple[dict, list[list[float]]]:
        """The table without its path, with times (s) and forces (N) of the curve."""
        points = [self._curve.time.tolist(), self._curve.force.tolist()]
        return self.model_dump(mode="json", exclude={"file", "points", *_READ}), points

    def record(self) -> Thrust:
        """Kernel record: the curve, or one pulse."""
        if self.use == "fit":
            fit = fit_gaussian(self._curve)
            pulses = Pulses(
                peaks=np.array([fit.peak]),
                centres=np.array([fit.centre]),
                widths=np.array([fit.width]),
                begin=-math.inf,
                end=math.inf,
            )
            return Thrust(pulses=pulses, curve=None)
        return Thrust(None, Curve(self._curve.time, self._curve.force))

    def requested(self) -> float:
        """Impulse (N s) of the curve that acts."""
        return float(np.trapezoid(self._curve.force, self._curve.time))

    def notes(self) -> list[str]:
        """What was read from the file, and the reading before ignition; nothing for a curve in the
        layout of tipoff that begins at zero."""
        return [text for text in (self._words, self._calm) if text]

    def usage(self) -> str:
        """Whether the points or the fit act, and their agreement."""
        acting = "the points act" if self.use == "curve" else "the Gaussian fit acts"
        acting = "; ".join([acting, *self.notes()])
        fit = self.fit()
        if fit is None:
            return f"{acting}, no Gaussian fits"
        return (
            f"{acting}; fit peak {fit.peak:.6g} N, centre {fit.centre:.6g} s, width "
            f"{fit.width:.6g} s, relative residual "
            f"{fit.relative_residual:.3g}, impulse {fit.impulse:.7g} N s against "
            f"{fit.curve_impulse:.7g} N s of the curve"
        )

    def details(self) -> dict[str, float | str]:
        """Which of curve and fit is used, and the fit."""
        used: dict[str, float | str] = {"use": self.use}
        fit = self.fit()
        if fit is None:
            return used
        return used | {
            "fit_peak_N": fit.peak,
            "fit_centre_s": fit.centre,
            "fit_width_s": fit.width,
            "fit_relative_residual": fit.relative_residual,
            "fit_impulse_Ns": fit.impulse,
            "curve_impulse_Ns": fit.curve_impulse,
        }
