"""A run as text: the answer with its error, or everything that is known of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from tipoff.mechanics import instant
from tipoff.mechanics.estimates import stop
from tipoff.results import answer
from tipoff.results.model_error import ModelError
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import verdicts
from tipoff.studies.runs.results import ByHand, ConditionRun
from tipoff.uncertain import number, uncertain
from tipoff.units import duration
from tipoff.workspace import disturbed, model_error
from tipoff.workspace.disturbed import Disturbed
from tipoff.workspace.study import Study

_INPUTS = "the values of the scene count as exact (--range varies them)"


class Detail(IntEnum):
    """How much of a run is printed: nothing, the answer with its error, or all (``--explain``)."""

    NOTHING, ANSWER, ALL = range(3)


@dataclass(frozen=True, kw_only=True)
class Single(ConditionRun):
    """A single run: its ``agreement`` as text, its changes when ``disturbed`` and its ``error`` (both
    None for the reference and if it does not settle), and ``failed``, a line if it is no success."""

    implausible: tuple[str, ...]
    agreement: str
    disturbed: Disturbed | None
    error: ModelError | None
    failed: tuple[str, ...]


def lines(row: Single, made_with: str, study: Study, detail: Detail = Detail.ANSWER) -> list[str]:
    """A run as lines of text with units."""
    said = f" ({row.message})" if row.message else ""
    text = [f"{study.scene.name} / {row.condition}, model {made_with}: {row.status}{said}"]
    every = detail == Detail.ALL
    if row.thrust and every:
        text.append(f"  thrust        {row.thrust['text']}")
    text += _stop(study.condition(row.condition))
    if row.advice and not row.failed:
        text.append(f"  advice        {row.advice}")
    if row.exit_time_s is not None:
        text.append(f"  exit          {duration(row.exit_time_s, 4)} after ignition{_after(row)}")
    text += _answer(row, every)
    text += _guides(row, every)
    text += _stress(row)
    if row.disturbed:
        limit = verdicts.gates(study.scene).settled_rate_error_deg_s
        text += [f"  warning       {words}" for words in disturbed.warnings(row.disturbed, limit)]
    text += _explained(row) if every else []
    return [*text, f"  trajectory    {study.path(row.trajectory)}"]


def _explained(row: Single) -> list[str]:
    """What the answer rests on, with its effect on the rates."""
    text = _parts(row)
    if row.disturbed:
        text += disturbed.lines(row.disturbed)
    text.append(f"  agreement     {row.agreement}")
    text.append(f"  took          {row.wall_s:.3g} s, {row.steps} steps")
    return text


def _parts(row: Single) -> list[str]:
    """Each part of the error in deg/s, with what is known of its cause."""
    parts = row.error.parts_deg_s if row.error else {}
    known = {
        model_error.RAIL_MESH: (row.rail_compliance or {}).get("words", ""),
        model_error.MODES: row.numerics.get("modes_why", ""),
        model_error.PATTERNS: row.numerics.get("degree_why", ""),
    }
    usual = {
        model_error.MODES: "if all modes vibrate",
        model_error.PATTERNS: "if the patterns of pressure have another degree",
        model_error.CELLS: "with twice as many along each edge of a pad",
    }
    text = []
    for name in dict.fromkeys([*parts, *known]):
        effect = f"moves a rate by {number(parts[name], '.2g')} deg/s" if name in parts else ""
        if name == model_error.TOLERANCE:  # of the line on the sensitivity
            continue
        first = " ".join(filter(None, [effect, usual.get(name, "") if effect else ""]))
        if told := ". ".join(filter(None, [first, known.get(name, "")])):
            text.append(f"  {name:<14}{told}")
    return text


def first(row: ConditionRun) -> str:
    """The rates of a long run before their error is known."""
    assert row.taken is not None
    rates = ", ".join(f"{rate:.3g}" for rate in row.taken.rate_deg_s)
    where = instant.where(row.at)
    return f"  rate {rates} deg/s (x, y, z), {where}; its error takes about ten more runs"


def _stop(scene: Scene) -> list[str]:
    """How long the payload rests on its stop, without a latch that holds it longer."""
    along = launch.of_scene(scene)
    left = stop.release_time(along)
    if not stop.is_there(along) or along.latched == left > 0.0:
        return []
    until = f"until {duration(left, 4)}: then" if math.isfinite(left) else "to the end: never"
    weight = f"the thrust exceeds its weight along the rail, {stop.weight(along):.4g} N"
    return [f"  stop          the payload rests on a stop behind it {until} {weight}"]


def _after(row: ConditionRun) -> str:
    share = row.impulse_after_exit
    return "" if share is None else f", {100.0 * share:.3g} % of the impulse after it"


def _answer(row: Single, every: bool) -> list[str]:
    """Velocity and rates at the instant that counts; all, or without these, those at the other one."""
    at_exit = row.at == instant.EXIT
    where = f", {instant.where(row.at)}" if at_exit else ""
    text = [] if (at_exit or not every) and row.taken else _at_exit(row)
    if (found := row.taken) is not None:
        own = answer.words(found.velocity_m_s, found.rate_deg_s, row.error)
        text += [
            f"  velocity      {own['velocity']}{where}",
            f"  rate          {own['rate']}{where}",
            f"  error         {_error(row.error)}",
            *(_by_hand_at_exit(row) if at_exit or every else []),
            *([] if at_exit else _by_hand(row, every)),
            f"  direction     {own['direction']}",
        ]
    if at_exit and every and row.settled is not None:
        text += [
            f"  burnt out     {answer.rates(row.settled.rate_deg_s)} (x, y, z), "
            f"{_vector(row.settled.velocity_m_s)} m/s, {instant.IN_A_VACUUM}",
            *_by_hand(row, every),
        ]
    return text


def _error(error: ModelError | None) -> str:
    """The largest part of the error, what the range of a sensitive run is, or why no error is known."""
    if error is None:
        return "not known: tipoff convergence measures that of the reference"
    if (own := error.range) is not None:
        lost = f"; {own.lost} more have no rates" if own.lost else ""
        return f"the range is that of {own.runs} runs within 1 µm of clearance{lost}; {_INPUTS}"
    if error.rate_deg_s is None:
        return f"not known: {error.not_known}"
    part = number(error.parts_deg_s[error.largest], ".2g", 1e-3)
    return f"mostly by the {error.largest}, {part} deg/s; {_INPUTS}"


def _guides(row: Single, every: bool) -> list[str]:
    """A line for each button or lug; for each pad only with ``every``, and so the rates of a sensitive run, whose
    answer is a range."""
    is_one_of_many = row.error is not None and row.error.range is not None
    return [
        f"  {guide.name:<14}{answer.of_guide(guide, every or not is_one_of_many)}"
        for guide in row.guides
        if every or not guide.name.startswith("pad")
    ]


def _by_hand(row: ConditionRun, every: bool) -> list[str]:
    """The settled rates by hand; with ``every``, or why there are none."""
    if row.by_hand is None:
        return [f"  by hand       not valid: {row.no_by_hand}"] if every and row.no_by_hand else []
    return [_hand_line(row.by_hand)]


def _by_hand_at_exit(row: ConditionRun) -> list[str]:
    """The rates at exit of a rocket by hand."""
    return [] if row.by_hand_at_exit is None else [f"{_hand_line(row.by_hand_at_exit)}, at exit"]


def _hand_line(found: ByHand) -> str:
    return f"  by hand       {answer.rates(found.rate_deg_s)}: {found.words}"


def _at_exit(row: ConditionRun) -> list[str]:
    """Speed and rates at exit, or why they are not known; nothing without an exit."""
    if row.exit_time_s is None:
        return []
    if row.at_exit is None:
        return [f"  at exit       not known: {row.no_exit_values}"]
    speed = uncertain(row.at_exit.velocity_m_s[0], least=1e-4)
    return [f"  at exit       {answer.rates(row.at_exit.rate_deg_s)} (x, y, z), v_x {speed} m/s"]


def _vector(values: Sequence[float]) -> str:
    return ", ".join(uncertain(value, least=1e-4) for value in values)


def _stress(row: ConditionRun) -> list[str]:
    if row.peak_stress_pa is None or row.peak_stress_time_s is None:
        return []
    place = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in row.peak_stress_place_m or ())
    return [
        f"  peak stress   {1e-6 * row.peak_stress_pa:.4g} MPa (von Mises) at x, y, z = "
        f"{place} mm, rail {row.peak_stress_rail}, "
        f"{duration(row.peak_stress_time_s, 4)} after ignition",
        *(f"  warning       {warning}" for warning in row.warnings),
    ]
