"""The first screen of the page: the scene itself with its range under random errors, then over all
conditions velocity and rates with their uncertainty, whether they are within the user's limits,
agreement and speed-up, and how far the answer can be trusted."""

import math
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from tipoff.mechanics.instant import EXIT, SETTLED, Instant, chosen
from tipoff.mechanics.instant import where as instant_words
from tipoff.results.model_error import Range
from tipoff.scenes import drawing
from tipoff.scenes.overrides import is_drop
from tipoff.studies.agreement import distribution_page, verdicts
from tipoff.studies.agreement import stage as compare
from tipoff.studies.agreement.distributions import Distribution
from tipoff.studies.agreement.page import counts
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.nominal import page as nominal_page
from tipoff.studies.nominal import stage as nominal_stage
from tipoff.studies.populations.exceedance import TOTAL, Limit
from tipoff.studies.render.document import Bullets, Heading, KeyFigures, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.report import trust
from tipoff.studies.runs.results import ConditionRun, roll, transverse
from tipoff.uncertain import (
    LEAST,
    STEPS,
    Measured,
    number,
    range_of,
    rounded,
    uncertain,
)
from tipoff.workspace.words import counted

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_NOTE = (
    "Means over 2 ms after exit and burnout, by the finite elements. Velocity is in the initial "
    "scene axes. Rates are inertial, in payload body axes: roll about X, transverse across it. "
    "±: the largest uncertainty of the reference by mesh, step and contact cells."
)
_RANGE_NOTE = (
    "A range in place of a value: the launch is sensitive, and the range is that of the same launch with payload "
    "and walls moved by less than 1 µm. Settled rates by finite elements on the coarse mesh, where the comparison "
    "has run them; all else by compliant contact. A dash: no neighbours were run for this value."
)
_EXIT_NOTE = (
    "At exit: means over 0.2 ms from the exit on, under the thrust that there is then. The impulse "
    "after the exit changes the rates of a free payload until burnout."
)
_AT_EXIT = (
    "at exit: roll, transverse (deg/s)",
    Column("impulse after exit", "%", ".2g", 100.0),
)
Spread = Distribution | Range  # rates of neighbours
Spreads = dict[str, Spread]  # by condition; settled, if nothing else is said
_BURNT = 1e-3  # of the impulse: a smaller share after the exit is not shown
_HAND_NOTE = (
    "By hand: the same two rates of a rigid payload, from the moment impulse of the thrust over "
    "the inertia. If one pad touches, the impulse of its force is added. Both must be near the "
    "finite elements. The gyroscopic moment is left out. Of a rocket that leaves under thrust: the rates at exit "
    "of a rigid rocket that turns about its rear button after the front one left."
)


def draw(page: "Page") -> list[Part]:
    """The answer of the scene itself, key figures over all conditions, the basis of the answer, the
    launcher with its axes, and a row for each condition."""
    nominal = page.result(nominal_stage.STAGE)
    first = nominal_page.draw(nominal) if nominal else []
    rows = page.rows()["highfi"]
    if not rows:
        return [*first, page.missing("highfi", "highfi"), drawing.launcher(page.scene)]
    agreement = page.result(compare.STAGE)
    compared = {row.condition: row for row in agreement.compliant} if agreement else {}
    ranges = {row.condition: row.range for row in page.rows()["lowfi"] if row.range}
    at = {row.condition: row.at for row in rows}
    settled = {name: own for name, own in ranges.items() if at.get(name) == SETTLED}
    spreads: Spreads = settled | _spreads(agreement)
    rates = [*_speed(page, rows), *_largest(rows, compared, spreads, settled)]
    limited: Spreads = {**ranges} if _instant(rows).at == EXIT else spreads
    figures = [*rates, *_limits(rows, page.limits, limited), *_models(page, agreement)]
    over_all = [KeyFigures(figures)]
    return [
        *first,
        *([Heading("Over all conditions"), *over_all] if first else over_all),
        Heading("How far it can be trusted"),
        Bullets(trust.lines(page.scene, compared, agreement)),
        drawing.launcher(page.scene),
        Heading("Every condition"),
        _conditions(page, rows, compared, spreads, ranges),
    ]


def above(
    row: ConditionRun, limits: Sequence[Limit], at: str, spread: Spread | None = None
) -> list[str] | None:
    """The axes on which a rate of a condition at an instant is above a limit; of any neighbour, if a ``spread``
    of rates at this instant replaces them. None without a rate."""
    values = row.at_exit if at == EXIT else row.settled
    if values is None:
        return None

    def largest(axis: str) -> float:
        def size(rates: Sequence[float]) -> float:
            return math.hypot(*rates) if axis == TOTAL else abs(rates["xyz".index(axis)])

        return size(values.rate_deg_s) if spread is None else spread.within(size)[1]

    return [limit.axis for limit in limits if largest(limit.axis) > limit.deg_s]


def _instant(rows: Sequence[ConditionRun]) -> Instant:
    """The instant of the limits: at the exit if any payload gets much of its impulse after it."""
    shares = [row.impulse_after_exit for row in rows if row.impulse_after_exit is not None]
    return chosen(None, max(shares, default=None))


def _spreads(agreement: Agreement | None) -> dict[str, Distribution]:
    """The distributions by condition; a range needs two neighbours that settled. It replaces a
    value whose uncertainty is larger than the value."""
    found = agreement.distributions if agreement else ()
    return {item.condition: item for item in found if len(item.settled_deg_s) > 1}


def _speed(page: "Page", rows: Sequence[ConditionRun]) -> list[tuple[str, str]]:
    """v_x over all conditions, with its uncertainty where the error of the reference was studied."""
    speeds = [row.settled.velocity_m_s[0] for row in rows if row.settled]
    if not speeds:
        return []
    low, high = (uncertain(speed, least=STEPS["m/s"]) for speed in (min(speeds), max(speeds)))
    studied = page.result(convergence.STAGE)
    known = [
        row.nominal_uncertainty
        for row in (studied.quantities if studied else ())
        if row.quantity == "settled axial velocity" and row.nominal_uncertainty is not None
    ]
    shown = low if low == high else f"{low} to {high}"
    if studied is None or not known:
        return [(shown, "v_x (m/s), uncertainty not measured (tipoff convergence)")]
    error = rounded(max(known), max(known), STEPS["m/s"])
    return [(shown, f"v_x (m/s), each ± {error} by mesh and step, measured on {studied.condition}")]


def _largest(
    rows: Sequence[ConditionRun],
    compared: dict[str, verdicts.JudgedCondition],
    spreads: Spreads,
    ranges: dict[str, Range],
) -> list[tuple[str, str]]:
    settled = {row.condition: row.settled for row in rows if row.settled}
    if not settled:
        return [("–", "no condition settled")]
    figures = []
    measures = {
        "largest transverse rate (deg/s)": transverse,
        "largest roll rate (deg/s)": lambda rate: abs(roll(rate)),
    }
    for words, measure in measures.items():

        def most(name: str, measure=measure) -> float:
            own = measure(settled[name].rate_deg_s)
            return max(own, spreads[name].within(measure)[1]) if name in spreads else own

        def shown(names: Iterable[str], measure=measure, most=most) -> tuple[str, str]:
            name = max(names, key=most)
            if name in spreads:
                return range_of(*spreads[name].within(measure)), name
            return uncertain(
                measure(settled[name].rate_deg_s), trust.uncertainty(compared.get(name))
            ), name

        value, name = shown(settled)
        sure = [one for one in settled if one not in compared or compared[one].reference_converged]
        words = f"{words}: {name}"
        if name in spreads:
            words += f", over {counted(_runs(spreads[name]), 'neighbour')} within 1 µm"
        elif name not in sure:
            words += ", not converged"
            words += "; of the converged ones {} ({})".format(*shown(sure)) if sure else ""
        figures.append((value, words))
    turned = {name: (own.direction_error_deg,) * 2 for name, own in settled.items()}
    turned |= {name: own.off_axis_deg for name, own in ranges.items()}
    name = max(turned, key=lambda name: turned[name][1])
    low, high = turned[name]
    off = number(high, ".2g", LEAST) if low == high else range_of(low, high, STEPS["deg"])
    return [*figures, (off, f"largest angle off axis (deg): {name}")]


def _runs(spread: Spread) -> int:
    """The number of neighbours that have rates."""
    return len(spread.rates_deg_s if isinstance(spread, Range) else spread.settled_deg_s)


def _limits(
    rows: Sequence[ConditionRun], limits: Sequence[Limit], spreads: Spreads
) -> list[tuple[str, str]]:
    if not limits:
        return []
    asked, at = ", ".join(limit.words for limit in limits), _instant(rows).at
    failed = [
        row.condition for row in rows if above(row, limits, at, spreads.get(row.condition)) != []
    ]
    where = f"all {len(rows)} conditions" if len(failed) == len(rows) else ", ".join(failed)
    lost = "without a rate there" if at == EXIT else "not settled"
    words = f"limits{_there(at)}: {asked}" + (f"; above or {lost}: {where}" if failed else "")
    return [("fail" if failed else "pass", words)]


def _there(at: str) -> str:
    return f" {instant_words(at)}" if at == EXIT else ""


def _models(page: "Page", agreement: Agreement | None) -> list[tuple[str, str]]:
    """Agreement and speed-up; empty before the comparison of both models."""
    if agreement is None:
        return []
    agree, words = counts(agreement.compliant)
    found = [(agree, f"{words}: surrogate against finite elements")]
    if equal := page.equal_accuracy:
        bound = "" if equal.surer else "at least, "
        words = f"faster, {bound}at equal accuracy (mesh of {1e3 * equal.element_size_m:g} mm)"
        return [*found, (f"{equal.ratio:,.0f} ×", words)]
    speed = agreement.speedup_compliant
    walls = f"{speed.highfi_wall_s:.2g} s against {1e3 * speed.lowfi_wall_s:.2g} ms"
    return [*found, (f"{speed.ratio:,.0f} ×", f"faster ({walls}); not at equal accuracy")]


def _conditions(
    page: "Page",
    rows: Sequence[ConditionRun],
    compared: dict[str, verdicts.JudgedCondition],
    spreads: Spreads,
    ranges: dict[str, Range],
) -> Table:
    at = _instant(rows).at
    columns: tuple[Column | str, ...] = (
        "condition",
        "what it changes",
        Column(Markup("v<sub>x</sub> (m/s)"), form=".4f"),
        "roll rate (deg/s)",
        "transverse rate (deg/s)",
        *(_AT_EXIT if _burns_on(rows) else []),
        *(["by hand: roll, transverse (deg/s)"] if _by_hand(rows) else []),
        Column("off axis", "deg", ".2g"),
        Column("surrogate error", "deg/s"),
        *([f"limits{_there(at)}"] if page.limits else []),
        "verdict",
    )
    found, kinds = [], []
    for row in rows:
        settled, other = row.settled, compared.get(row.condition)
        spread, own = spreads.get(row.condition), ranges.get(row.condition)
        limited = own if at == EXIT else spread
        found.append(
            [
                row.condition,
                stated(page, row.condition),
                *(_rates(row, trust.uncertainty(other), spread, own) if settled else [None] * 3),
                *(_at_exit(row, own) if _burns_on(rows) else []),
                *([_hand(row)] if _by_hand(rows) else []),
                settled and _off_axis(row, own),
                other
                and Measured(other.settled_rate_error_deg_s, other.floor_deg_s, magnitude=True),
                *([_words(above(row, page.limits, at, limited))] if page.limits else []),
                other.verdict if other else row.status,
            ]
        )
        kinds.append(_kind(other))
    notes = (
        _NOTE,
        *([_EXIT_NOTE] if _burns_on(rows) else []),
        *([_RANGE_NOTE] if spreads or ranges else []),
        *([_HAND_NOTE] if _by_hand(rows) else []),
    )
    return Table(columns, found, notes=notes, kinds=kinds, name="answer-table")


def _rates(
    row: ConditionRun, uncertainty: float | None, spread: Spread | None, own: Range | None
) -> list:
    """Settled v_x, roll and transverse rate; of a sensitive run the range, None where it has its own range at
    the exit alone."""
    assert row.settled is not None
    speed, rate = row.settled.velocity_m_s[0], row.settled.rate_deg_s
    if own is not None:
        ends = own.low_m_s[0], own.high_m_s[0]
        shown: list[Any] = [range_of(*ends, least=STEPS["m/s"]) if row.at == SETTLED else None]
    else:
        shown = [speed]
    if spread is not None:
        return [*shown, *(range_of(*spread.within(measure)) for measure in (roll, transverse))]
    if own is not None:
        return [*shown, None, None]
    return [*shown, uncertain(roll(rate), uncertainty), uncertain(transverse(rate), uncertainty)]


def _off_axis(row: ConditionRun, own: Range | None) -> Any:
    """The settled direction of the velocity, as a range of a sensitive run."""
    assert row.settled is not None
    if own is None:
        return row.settled.direction_error_deg
    return range_of(*own.off_axis_deg, least=STEPS["deg"]) if row.at == SETTLED else None


def _burns_on(rows: Sequence[ConditionRun]) -> bool:
    """Whether any payload leaves its rail under thrust."""
    return any((row.impulse_after_exit or 0.0) > _BURNT for row in rows)


def _at_exit(row: ConditionRun, own: Range | None) -> list:
    """Roll and transverse rate at exit, and the share of the impulse after it."""
    rate = row.at_exit and row.at_exit.rate_deg_s
    shown = f"{uncertain(roll(rate))}, {uncertain(transverse(rate))}" if rate else None
    if rate and own is not None:
        ends = ", ".join(range_of(*own.within(measure)) for measure in (roll, transverse))
        shown = ends if row.at == EXIT else None
    return [shown or row.no_exit_values or None, row.impulse_after_exit]


def _by_hand(rows: Sequence[ConditionRun]) -> bool:
    """Whether any of the rates can be computed by hand."""
    return any(_hand(row) for row in rows)


def _hand(row: ConditionRun) -> str | None:
    """Roll and transverse rate by hand at the instant that counts for the run, where that is valid."""
    found = row.by_hand_at_exit if row.at == EXIT else row.by_hand
    if found is None:
        return None
    rate = found.rate_deg_s
    return f"{uncertain(roll(rate))}, {uncertain(transverse(rate))}"


def _words(over: list[str] | None) -> str:
    if over is None:
        return "✗ no rate"
    return f"✗ {', '.join(over)}".replace(" ", "\u00a0") if over else "✓ pass"


def _kind(row: verdicts.JudgedCondition | None) -> str:
    return "" if row is None else distribution_page.kind(row.judgement)


def stated(page: "Page", name: str) -> str:
    """What a condition changes in the scene."""
    found: dict[str, list[str]] = {}
    for key, value in page.scene.conditions.get(name, {}).items():
        table_, _, last = key.rpartition(".")
        if is_drop(value):
            found[f"no {_short(key)}"] = []
            continue
        found.setdefault(_short(table_), []).append(f"{last.replace('_', ' ')} {_readable(value)}")
    parts = [f"{table_} {', '.join(values)}".strip() for table_, values in found.items()]
    return "; ".join(parts) or "the scene itself"


def _short(key: str) -> str:
    """The last word of a key; for an eccentricity also its owner, since both thrust and mass have
    one."""
    owner, _, last = key.rpartition(".")
    words = f"{owner.removesuffix('_offset')} {last}" if last == "eccentricity" else last
    return words.replace("_", " ")


def _readable(value: Any) -> str:
    """A value of an override: numbers of at most four digits."""
    text = _LONG.sub(lambda found: f"{float(found[0]):.4g}", str(value))
    return re.sub(r"\bum\b", "µm", text)


_LONG = re.compile(r"\d+\.\d{5,}(?![\d.eE])")
