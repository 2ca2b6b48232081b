"""One drop test from its sheet to its change of rate: the steps of the other files in order."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.studies.measured import events as finding
from tipoff.studies.measured.channel_class import filtered
from tipoff.studies.measured.events import WINDOWS, Events, Spans, inside
from tipoff.studies.measured.log import Calibrated, Log, calibrated, missing_information, read
from tipoff.studies.measured.reduction import Reduced, reduced
from tipoff.studies.measured.sheet import Sheet


class Drop(NamedTuple):
    """A drop test: its sheet, calibrated samples, filtered rate (n,3) rad/s, ``doubtful`` samples
    (n,) that are missing, frozen or clipped, events, windows, change of rate, largest rate (rad/s) in the
    window at rest. ``notes`` state in words what was repaired, assumed or left out."""

    name: str
    sheet: Sheet
    samples: Calibrated
    filtered: np.ndarray
    doubtful: np.ndarray
    events: Events
    spans: Spans
    reduced: Reduced
    unrest: float
    notes: list[str]


def analyse(path: str | Path) -> Drop:
    """The whole analysis of one log. Raises SceneError listing every fault."""
    sheet, log = read(path)
    assert isinstance(sheet, Sheet)  # of a drop test
    return drop_of(sheet, log, str(path))


def drop_of(sheet: Sheet, log: Log, source: str) -> Drop:
    """The same for a log that is already read."""
    samples = calibrated(sheet, log)
    smooth = filtered(samples.rate, sheet.channel_class, log.interval)
    try:
        events = finding.find(sheet, samples, source)
        spans = finding.spans(sheet, samples, events, source)
    except SceneError as error:  # an event may not show in a frozen acceleration
        raise SceneError([*(each.fault for each in log.frozen), *error.faults]) from error
    _require_whole(log, spans, source)
    result = reduced(sheet, samples, spans, source)
    unrest = float(np.abs(smooth[inside(log.time, spans.rest)]).max())
    return Drop(
        Path(source).stem,
        sheet,
        samples=samples,
        filtered=smooth,
        doubtful=np.any(
            [log.doubtful, log.clipped, *(held.covers(log.time) for held in log.frozen)], 0
        ),
        events=events,
        spans=spans,
        reduced=result,
        unrest=unrest,
        notes=_notes(sheet, log, events, unrest),
    )


def _require_whole(log: Log, spans: Spans, source: str) -> None:
    """Check that no window has a gap, a frozen channel, a clipped rate, or a clipped acceleration
    that compensates the rate. Raises SceneError otherwise."""
    ends = [getattr(spans, name) for name in WINDOWS]
    faults = [
        held.fault
        for held in log.frozen
        if any(held.begin <= last and held.end >= first for first, last in ends)
    ]
    for name in WINDOWS:
        places = inside(log.time, getattr(spans, name))
        if bad := int((log.doubtful | log.clipped)[places].sum()):
            faults.append(
                Fault(
                    source,
                    f"{name} window",
                    f"{bad} of {places.size} samples missing or clipped",
                    "none",
                )
            )
    if faults:
        raise SceneError(faults)


def _notes(sheet: Sheet, log: Log, events: Events, unrest: float) -> list[str]:
    notes = [*log.notes, *missing_information(sheet, log)]
    notes += [
        f"{held.fault.key}: {held.fault.given}: the channel is frozen there, outside of every window"
        for held in log.frozen
    ]
    if sheet.channel_class is None:
        notes.append(f"no channel class: {1.0 / log.interval:.4g} Hz, nothing is filtered")
    if events.given:
        notes.append("release and ignition from the sheet")
    if events.later:
        times = ", ".join(f"{at:.4g} s" for at in events.later)
        notes.append(
            f"also accelerated along +X after ignition, as long as by a burn, at {times}: taken "
            "for the catch"
        )
    if unrest > sheet.windows.rest_rate:
        notes.append(
            f"settling rule broken: {np.degrees(unrest):.3g} deg/s in the {sheet.windows.rest:g} s "
            f"before release, "
            f"{np.degrees(sheet.windows.rest_rate):g} deg/s allowed"
        )
    if log.acceleration is None:
        notes.append(
            "no accelerations: the budget takes the specific force as the same in both windows"
        )
    return notes
