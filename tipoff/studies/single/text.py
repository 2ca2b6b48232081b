"""A run as text: the answer with its error, or everything that is known of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from tipoff.mechanics import instant
from tipoff.mechanics.estimates import stop
from tipoff.results.guides import Guide
from tipoff.results.model_error import ModelError, Range
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import verdicts
from tipoff.studies.render.uncertain import number, range_of, rounded, uncertain
from tipoff.studies.runs.results import AtExit, ByHand, ConditionRun, Settled
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
        own = row.error.range if row.error is not None else None
        velocity = _vector(found.velocity_m_s) if own is None else _spans(own)
        text += [
            f"  velocity      {velocity} m/s (x, y, z){where}",
            *_rates(row, found.rate_deg_s, where),
            *([] if not every else _by_hand_at_exit(row)),
            *([] if at_exit or not every else _by_hand(row)),
            f"  direction     {_direction(found) if own is None else _directions(own)}",
        ]
    if at_exit and every and row.settled is not None:
        rates = ", ".join(map(uncertain, row.settled.rate_deg_s))
        text += [
            f"  burnt out     {rates} deg/s (x, y, z), {_vector(row.settled.velocity_m_s)} m/s, "
            f"{instant.IN_A_VACUUM}",
            *_by_hand(row),
        ]
    return text


def _direction(found: Settled | AtExit) -> str:
    off, across = found.direction_error_deg, 1e3 * found.lateral_velocity_m_s
    return f"{off:.4g} deg off axis, {across:.4g} mm/s across"


def _spans(found: Range) -> str:
    """The velocity of a sensitive run."""
    ends = zip(found.low_m_s, found.high_m_s)
    return ", ".join(range_of(low, high, least=1e-4) for low, high in ends)


def _directions(found: Range) -> str:
    """The direction of a sensitive run."""
    across = range_of(*(1e3 * end for end in found.across_m_s))
    return f"{range_of(*found.off_axis_deg, least=1e-4)} deg off axis, {across} mm/s across"


def _rates(row: Single, rate: Sequence[float], where: str) -> list[str]:
    """The rates with their error, or as the range of a sensitive run, and the largest part of the
    error."""
    error, total = row.error, math.hypot(*rate)
    if error is not None and error.range is not None:
        own = error.range
        spans = ", ".join(map(range_of, own.low_deg_s, own.high_deg_s))
        lost = f"; {own.lost} more have no rates" if own.lost else ""
        return [
            f"  rate          {spans} deg/s (x, y, z){where}",
            f"  error         the range is that of {own.runs} runs within 1 µm of clearance{lost}; {_INPUTS}",
        ]
    known = error.rate_deg_s if error is not None else None
    if error is None or known is None:
        why = (
            "tipoff convergence measures that of the reference"
            if error is None
            else error.not_known
        )
        shown = ", ".join(map(uncertain, rate))
        return [
            f"  rate          {shown} deg/s (x, y, z), {uncertain(total)} in total{where}",
            f"  error         not known: {why}",
        ]
    shown = ", ".join(rounded(value, known) for value in rate)
    part = number(error.parts_deg_s[error.largest], ".2g", 1e-3)
    return [
        f"  rate          {shown} ± {rounded(known, known)} deg/s (x, y, z), "
        f"{rounded(total, known)} in total{where}",
        f"  error         mostly by the {error.largest}, {part} deg/s; {_INPUTS}",
    ]


def _guides(row: Single, every: bool) -> list[str]:
    """A line for each button; for each pad only with ``every``, and so the rates of a sensitive run, whose
    answer is a range."""
    is_one_of_many = row.error is not None and row.error.range is not None
    return [
        f"  {guide.name:<14}{'; '.join(_of_guide(guide, every or not is_one_of_many))}"
        for guide in row.guides
        if guide.name.startswith("button") or every
    ]


def _of_guide(guide: Guide, rates: bool) -> list[str]:
    """When a guide leaves the rail, if asked with the ``rates`` then, and its largest force."""
    words = [f"x = {1e3 * guide.place_m[0]:.4g} mm"]
    if guide.leaves_s is None or guide.speed_m_s is None or guide.rate_rad_s is None:
        words.append("does not leave the rail")
    else:
        then = ", ".join(uncertain(math.degrees(rate)) for rate in guide.rate_rad_s)
        words.append(
            f"leaves at {duration(guide.leaves_s, 4)}, {uncertain(guide.speed_m_s)} m/s"
            + (f", {then} deg/s" if rates else "")
        )
    if guide.largest_force_n is None or guide.largest_force_time_s is None:
        return [*words, "no force"]
    force = (
        f"largest force {guide.largest_force_n:.3g} N at {duration(guide.largest_force_time_s, 4)}"
    )
    if guide.moment_n_m is not None:
        force += f", {math.hypot(*guide.moment_n_m):.3g} N m at its foot"
    return [*words, force]


def _by_hand(row: ConditionRun) -> list[str]:
    """The settled rates by hand, or why there are none."""
    if row.by_hand is None:
        return [f"  by hand       not valid: {row.no_by_hand}"] if row.no_by_hand else []
    return [_hand_line(row.by_hand)]


def _by_hand_at_exit(row: ConditionRun) -> list[str]:
    """The rates at exit of a rocket by hand."""
    return [] if row.by_hand_at_exit is None else [f"{_hand_line(row.by_hand_at_exit)}, at exit"]


def _hand_line(found: ByHand) -> str:
    rates = ", ".join(map(uncertain, found.rate_deg_s))
    return f"  by hand       {rates} deg/s: {found.words}"


def _at_exit(row: ConditionRun) -> list[str]:
    """Speed and rates at exit, or why they are not known; nothing without an exit."""
    if row.exit_time_s is None:
        return []
    if row.at_exit is None:
        return [f"  at exit       not known: {row.no_exit_values}"]
    rates = ", ".join(map(uncertain, row.at_exit.rate_deg_s))
    speed = uncertain(row.at_exit.velocity_m_s[0], least=1e-4)
    return [f"  at exit       {rates} deg/s (x, y, z), v_x {speed} m/s"]


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
