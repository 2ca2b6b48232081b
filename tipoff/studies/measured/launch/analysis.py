"""One launch from its sheet to its quantities: the steps of the other files in order."""

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from tipoff.faults import Fault, SceneError
from tipoff.scenes.scene import Scene
from tipoff.studies.measured.events import AT_REST, GRAVITY
from tipoff.studies.measured.launch import budget, ends
from tipoff.studies.measured.launch.budget import Motion, Moved
from tipoff.studies.measured.launch.quantities import (
    BY_AXIS,
    LATERAL,
    SPEED,
    TIME,
    Stated,
    over_way,
    rate_name,
)
from tipoff.studies.measured.launch.record import Record, first_rise, reduced, threshold, travelled
from tipoff.studies.measured.log import Calibrated, Log, calibrated, missing_information
from tipoff.studies.measured.reduction import COVERAGE
from tipoff.studies.measured.sheet import LaunchSheet
from tipoff.units import duration

_GUARD = 5.0  # intervals between the window at rest and the start
_LASTING = 5e-3  # s of the rise at the start
_FEWEST = 5  # samples after the exit
_NORMAL = float(scipy.stats.norm.ppf(0.5 + 0.5 * COVERAGE))
_APART = 3.0  # standard uncertainties
_OTHER_SLOPE = 0.03  # of g: difference of gravity along the rail that is told


class Launched(NamedTuple):
    """A launch: its sheet, calibrated samples and ``record``; ``rest``: a mask (n,) of the window at rest;
    ``start`` (s of the log); the quantities with their uncertainties; ``motion`` and ``rates``: parts of the
    uncertainty of the exit and of the rates (rad/s); ``gravity``: specific force at rest along the rail and
    that of the scene (m/s2); ``rise`` (m/s2) of the force that counts as the start; ``notes``."""

    name: str
    sheet: LaunchSheet
    samples: Calibrated
    record: Record
    rest: np.ndarray
    start: float
    stated: dict[str, Stated]
    motion: dict[str, Moved]
    rates: dict[str, np.ndarray]
    gravity: tuple[float, float]
    rise: float
    notes: list[str]


def analyse(sheet: LaunchSheet, log: Log, scene: Scene, source: str) -> Launched:
    """The whole analysis of a log that is read. Raises SceneError."""
    samples = calibrated(sheet, log)
    assert samples.force is not None  # its sheet has accelerations
    rest, first = _start(sheet, samples, source)
    start = float(samples.time[first]) + 0.5 * sum(budget.SPAN) * log.interval
    gravity = float(samples.force[rest, 0].mean())
    found = Motion(samples.time - start, samples.force[:, 0] - gravity, rest, log.interval)
    left, spread, notes = _exit(sheet, found, samples, ends.travel(scene), source)
    motion = budget.of_motion(sheet, found, left, spread)
    sure = budget.combined(motion)
    _require_whole(log, (float(samples.time[rest][0]), start + left + sheet.launch.after), source)
    exit_ = (left - sure.instant, left + sure.instant)
    _require_free(sheet, found, left + budget.CLEAR * sure.instant, source)
    own = reduced(samples, rest, start, gravity, exit_, sheet.launch.after)
    rates = budget.of_rates(sheet, samples, own, rest, sure.instant)
    expected = -scene.gravity.x if scene.gravity else 0.0
    if abs(gravity - expected) > _OTHER_SLOPE * GRAVITY:
        notes.append(
            f"at rest the specific force along the rail is {gravity:.3g} m/s2, gravity of the scene gives "
            f"{expected:.3g} m/s2: the rail has another inclination, or the axes are wrong"
        )
    return Launched(
        name=source,
        sheet=sheet,
        samples=samples,
        record=own,
        rest=rest,
        start=start,
        stated=_stated(own, sure, rates),
        motion=motion,
        rates=rates.parts,
        gravity=(gravity, expected),
        rise=threshold(samples.force[rest, 0]),
        notes=[*log.notes, *missing_information(sheet, log), *notes],
    )


def _stated(own: Record, sure: Moved, rates: budget.Rates) -> dict[str, Stated]:
    speed = own.at_exit(own.speed)[0]
    found = {
        TIME: Stated(own.left, sure.time, _NORMAL * sure.time),
        SPEED: Stated(speed, sure.speed, _NORMAL * sure.speed),
    }
    degrees, spread = np.degrees(rates.rate), np.degrees(rates.combined)
    for axis, name in enumerate("xyz"):
        expanded = float(rates.factor[axis] * spread[axis])
        found[rate_name(name)] = Stated(float(degrees[axis]), float(spread[axis]), expanded)
    across = float(np.hypot(*degrees[1:]))
    unsure = float(np.hypot(*spread[1:]) / np.sqrt(2.0))
    found[LATERAL] = Stated(across, unsure, float(rates.factor[1:].max()) * unsure)
    for name, value in over_way(own, own.rate, BY_AXIS).items():
        found[name] = Stated(value)
    return found


def _start(sheet: LaunchSheet, found: Calibrated, source: str) -> tuple[np.ndarray, int]:
    """The window at rest as a mask (n,), and the first sample that moves. The log begins at rest."""
    assert found.force is not None
    time, ask = found.time, sheet.launch
    interval = float(time[1] - time[0])
    begin = time < time[0] + ask.at_rest
    lasting = max(3, int(np.ceil(_LASTING / interval)))
    first = first_rise(found.force[:, 0], begin, lasting)
    if first is None:
        expected = (
            f"a log that begins with {duration(ask.at_rest)} at rest, launch.at_rest, and a force along +X that "
            "rises by a tenth of g and more; are the axes correct?"
        )
        raise SceneError([Fault(source, "start", "no rise of the force along +X", expected)])
    last = float(time[first]) - _GUARD * interval
    rest = (time >= last - ask.at_rest) & (time <= last)
    size = float(np.linalg.norm(found.force[rest].mean(axis=0)))
    if abs(size / GRAVITY - 1.0) > AT_REST:
        given, expected = (
            f"{size:.4g} m/s2 at rest",
            f"{GRAVITY:.4g} m/s2 within {100.0 * AT_REST:g} %",
        )
        words = f"{expected}: unit, scale or bias is wrong"
        raise SceneError([Fault(source, "units.acceleration", given, words)])
    return rest, first


def _exit(
    sheet: LaunchSheet, found: Motion, samples: Calibrated, length: float, source: str
) -> tuple[float, float | None, list[str]]:
    """The instant of the exit (s from the start), its standard uncertainty unless it follows from the way, and
    notes."""
    asked = sheet.launch.exit
    if isinstance(asked, tuple):
        low, high = (float(at) - float(samples.time[0] - found.time[0]) for at in asked)
        if not 0.0 < low < high < found.time[-1]:
            expected = "two rising instants after the start, inside the log"
            raise SceneError(
                [Fault(source, "launch.exit", f"{asked[0]:g} s, {asked[1]:g} s", expected)]
            )
        return 0.5 * (low + high), 0.5 * (high - low), ["exit from the sheet"]
    _, way = travelled(found.time, found.along)
    noise, left = _noise(found, samples, way, length), ends.by_way(found.time, way, length)
    apart = ""
    if noise is not None and left is not None:
        unsure = budget.combined(budget.of_motion(sheet, found, left)).instant
        if abs(noise[0] - left) > _APART * np.hypot(unsure, noise[1]):
            apart = (
                f"the noise of contact ends {duration(noise[0], 4)} after the start, the travel of "
                f"{length:.4g} m at {duration(left, 4)}"
            )
    if asked == "contact":
        if noise is None:
            expected = (
                'noise of contact that ends; launch.exit = "way" takes the travel of the scene'
            )
            raise SceneError([Fault(source, "launch.exit", "no end of the noise", expected)])
        return *noise, [f"{apart}: guides may slide quietly to the end"] if apart else []
    if left is None:
        expected = f"the travel of the scene, {length:.4g} m"
        given = f"{way[-1]:.4g} m of way in the whole log"
        raise SceneError([Fault(source, "launch.exit", given, expected)])
    # contact that ends earlier is no contradiction: guides may slide quietly
    late = apart and noise is not None and noise[0] > left
    return left, None, [f"{apart}: is the rail longer?"] if late else []


def _noise(
    found: Motion, samples: Calibrated, way: np.ndarray, length: float
) -> tuple[float, float] | None:
    """The end of the noise of contact between half and twice the travel."""
    assert samples.force is not None
    ends_ = [ends.by_way(found.time, way, share * length) for share in (0.5, 2.0)]
    if ends_[0] is None:
        return None
    last = float(found.time[-1]) if ends_[1] is None else ends_[1]
    part = (found.time > 0.25 * ends_[0]) & (found.time <= last)
    signals = np.column_stack([samples.force[:, 1:], samples.rate])[part]
    return ends.by_contact(found.time[part], signals, (ends_[0], last))


def _require_free(sheet: LaunchSheet, found: Motion, begin: float, source: str) -> None:
    """Check that the log has samples from ``begin`` on (s from the start) up to ``after`` behind the exit."""
    part = (found.time >= begin) & (found.time <= begin + sheet.launch.after)
    if part.sum() < _FEWEST or found.time[-1] < begin:
        expected = f"{_FEWEST} samples after the exit, within launch.after and in the log"
        raise SceneError([Fault(source, "launch.after", f"{part.sum()} samples", expected)])


def _require_whole(log: Log, span: tuple[float, float], source: str) -> None:
    """Check that the log has every sample from the rest to the rates after the exit."""
    faults = [held.fault for held in log.frozen if held.begin <= span[1] and held.end >= span[0]]
    part = (log.time >= span[0]) & (log.time <= span[1])
    if bad := int((log.doubtful | log.clipped)[part].sum()):
        given = f"{bad} of {part.sum()} samples missing or clipped"
        faults.append(Fault(source, "launch", given, "none from the rest to the free flight"))
    if faults:
        raise SceneError(faults)
