"""Release and ignition in the accelerations, and the windows that follow from them.

**Release**: the accelerometers of a hanging platform measure g, in free fall zero. Free fall is the first
interval in which the filtered force stays below g/2 for 50 ms. A knock is shorter. The beginning is where
a step from the mean force before to zero fits the unfiltered samples best (least squares, which is
maximum likelihood for white noise).

**Ignition**: the burn is the first interval after release in which the force along +X exceeds six
standard deviations of its noise (and 1 m/s2) and has the impulse of an ejection. Its beginning is
ignition. A latch may knock harder, but for a shorter time. The catch of the platform may push for longer
than the thruster, but it comes later.
"""

from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.studies.measured.channel_class import filtered, reach
from tipoff.studies.measured.log import Calibrated, runs
from tipoff.studies.measured.sampling import FALL
from tipoff.studies.measured.sheet import Sheet

GRAVITY = 9.80665
WINDOWS = ("rest", "reference", "settled")
_NOISE_FROM, _NOISE_TO = 0.01, 0.05  # s after release, where the noise of the force is judged
_SIGMAS, _LEAST = 6.0, 1.0  # a sample that belongs to the burn: standard deviations, and m/s2
_JOINED = 0.002  # s between samples of one burn
_IMPULSE = 0.3  # m/s, the smallest impulse per mass of an ejection
AT_REST = 0.05  # relative error of g while hanging, beyond which units or scale are wrong
_SHORTEST = 0.03  # s of a window
_GUARDED = 2.0  # samples between an event and a window, at least
_ROUNDING = 1e-6  # of an interval: rounding of instants, which are sums of decimal times


class Events(NamedTuple):
    """Instants (s of the log), and whether they are found or given; ``later``: begins of further
    pushes after the exit that are as long as a burn, which are taken for the catch."""

    release: float
    ignition: float
    given: bool
    later: tuple[float, ...] = ()


class Spans(NamedTuple):
    """First and last instant (s) of the windows: at ``rest`` before release, ``reference`` in free
    fall, ``settled`` after exit; ``instant`` is of the settled rate, in the middle of the
    window over which simulations take it."""

    rest: tuple[float, float]
    reference: tuple[float, float]
    settled: tuple[float, float]
    instant: float


def find(sheet: Sheet, found: Calibrated, source: str) -> Events:
    """Release and ignition. Raises SceneError for a log without one of them, or whose resting force
    is not g."""
    if sheet.events is not None:
        return Events(sheet.events.release, sheet.events.ignition, True)
    interval = found.time[1] - found.time[0]
    release = _release(sheet, found, interval, source)
    hanging = _force(found)[: max(1, release - int(_NOISE_FROM / interval))]
    measured = float(np.linalg.norm(hanging.mean(axis=0)))
    if abs(measured / GRAVITY - 1.0) > AT_REST:
        raise SceneError(
            [
                Fault(
                    source,
                    "units.acceleration",
                    f"{measured:.4g} m/s2 at rest",
                    f"{GRAVITY:.4g} m/s2 within {100.0 * AT_REST:g} %: unit, scale or bias is "
                    f"wrong",
                )
            ]
        )
    ignition, *others = (
        float(found.time[place]) for place in _pushes(found, interval, release, source)
    )
    return Events(
        float(found.time[release]),
        ignition,
        False,
        tuple(at for at in others if at > ignition + sheet.windows.exit),
    )


def _force(found: Calibrated) -> np.ndarray:
    """The specific force (n,3). A log has it unless its sheet states the events."""
    assert found.force is not None
    return found.force


def _release(sheet: Sheet, found: Calibrated, interval: float, source: str) -> int:
    force = _force(found)
    smooth = np.linalg.norm(filtered(force, sheet.channel_class, interval), axis=1)
    falls = [run for run in runs(smooth < 0.5 * GRAVITY) if run[1] - run[0] >= FALL / interval]
    if not falls or falls[0][0] == 0:
        given = "a log that begins in free fall" if falls else "no free fall"
        expected = f"a force that falls from g to zero for at least {1e3 * FALL:g} ms"
        raise SceneError([Fault(source, "release", given, expected)])
    crossing = falls[0][0]
    span = max(3, int(np.ceil(reach(sheet.channel_class) / interval)))
    low, high = max(crossing - span, 1), min(crossing + span, found.time.size - 1)
    before = force[max(0, low - 5 * span) : low].mean(axis=0)
    measured = force[low:high] @ before / (before @ before)  # 1 while hanging, 0 in free fall
    # Residual sum of squares of a step after k samples, without a constant part.
    wrong = np.concatenate([[0.0], np.cumsum((measured - 1.0) ** 2 - measured**2)])
    return low + int(np.argmin(wrong))


def _pushes(found: Calibrated, interval: float, release: int, source: str) -> list[int]:
    """Where pushes along +X with the impulse of an ejection begin, in order. Raises SceneError
    where there is none."""
    ahead = _force(found)[:, 0]
    begin, end = (release + int(after / interval) for after in (_NOISE_FROM, _NOISE_TO))
    calm = ahead[begin:end]
    level = np.median(calm)
    limit = max(_SIGMAS * 1.4826 * np.median(np.abs(calm - level)), _LEAST)
    pushed = np.flatnonzero(ahead[begin:] - level > limit) + begin
    burns = np.split(pushed, np.flatnonzero(np.diff(pushed) > max(_JOINED / interval, 1.0)) + 1)
    strong = [
        int(burn[0])
        for burn in burns
        if burn.size and interval * float(ahead[burn].sum()) >= _IMPULSE
    ]
    if not strong:
        expected = f"an impulse per mass of at least {_IMPULSE} m/s; are the axes correct?"
        raise SceneError(
            [Fault(source, "ignition", "no acceleration along +X in free fall", expected)]
        )
    return strong


def spans(sheet: Sheet, found: Calibrated, events: Events, source: str) -> Spans:
    """The windows. Raises SceneError if the log does not contain them, or if they are too short."""
    from tipoff.mechanics.run_limits import SETTLE_DELAY, SETTLE_WINDOW

    interval = float(found.time[1] - found.time[0])
    ask, guard = sheet.windows, max(reach(sheet.channel_class), _GUARDED * interval)
    left = events.ignition + ask.exit
    settled = left + SETTLE_DELAY + 2.0 * ask.exit_uncertainty
    spans_ = Spans(
        (events.release - ask.rest, events.release - guard),
        (events.release + ask.after_release, events.ignition - guard),
        (settled, settled + ask.settled),
        left + SETTLE_DELAY + 0.5 * SETTLE_WINDOW,
    )
    faults = []
    # A window that ends less than half an interval outside the log has the same samples.
    slack = 0.5 * interval
    first, last = found.time[0] - slack, found.time[-1] + slack
    for name in WINDOWS:
        begin, end = getattr(spans_, name)
        if end - begin < _SHORTEST - _ROUNDING * slack or begin < first or end > last:
            faults.append(
                Fault(
                    source,
                    f"{name} window",
                    f"{begin:.4g} to {end:.4g} s",
                    f"{1e3 * _SHORTEST:g} ms and more inside the log, {found.time[0]:.4g} to "
                    f"{found.time[-1]:.4g} s",
                )
            )
    if faults:
        raise SceneError(faults)
    return spans_


def inside(time: np.ndarray, span: tuple[float, float]) -> np.ndarray:
    """Places (k,) of the instants (n,) that lie in a window."""
    slack = _ROUNDING * float(time[1] - time[0]) if time.size > 1 else 0.0
    return np.flatnonzero((time >= span[0] - slack) & (time <= span[1] + slack))
