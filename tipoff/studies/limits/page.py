"""Certified tolerances: a table beside the paper's advice or the tolerances of a file of errors, the share
of cases above a limit by tolerance, and a map of two tolerances."""

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

from tipoff.studies.limits.certificate import Certificate, Stratum
from tipoff.studies.limits.results import Advised, CertifiedFactor, Limits, Map
from tipoff.studies.limits.search import ALL, FOUND, LOST, NONE, SMALL, Found
from tipoff.studies.limits.within import TOGETHER
from tipoff.studies.populations import exceedance, population
from tipoff.studies.render.chart import Chart, Line, Panel, marks
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, TEAL, VERMILION
from tipoff.studies.render.table import Column, Table, estimate, percent, span
from tipoff.workspace.words import counted

_CURVES = (
    "Share of {cases:,} cases above a limit against the tolerance, with the same draws at every "
    "tolerance. Dotted: its upper bound at {confidence:.0%} confidence; horizontal: the allowed "
    "share 1 - p. Vertical: the largest certified tolerance; dashed: {known}."
)
_MAP = (
    "Both errors vary; on an axis the other error is zero. Pairs between the line and the "
    "origin are certified. Square: the advice of the paper."
)
_TOLERANCE = (
    "A tolerance is three sigma of a normal distribution; larger values are drawn again. The "
    "direction of an error is random. One factor varies at a time, and the errors of the others "
    "are {others}. The last row scales a whole set."
)
_OF_FILE = (
    "A tolerance is a multiple of the scatter of {vary}, whose distributions the cases have; its number of "
    "cases and seed are not used. One tolerance varies at a time, and the other inputs are {others}. The last "
    "row scales all. Ranges have 95 % of the values. A case that the scene refuses counts as above."
)
_CERTIFIED = (
    "Certified: the upper bound of the probability that a rate is above its limit is at most "
    "{most:.4g} ({confidence:.0%} confidence; of {cases:,} cases {allowed:,} may be above)."
)
_ADVICE = (
    "The paper advises the tolerances at which rates stop growing with the error. It gives no "
    "limit and no probability."
)
_REASONS = {
    NONE: "none, a limit is exceeded even at zero",
    LOST: "none, the model error exceeds a limit",
}
_Columns = tuple[tuple[str, Callable[[CertifiedFactor], Any]], ...]
_FIRST: _Columns = (
    ("tolerance of", lambda row: row.words + _unit(row.unit, " ({})")),
    ("largest certified", lambda row: value(row.nominal)),
)
_PAPER: _Columns = (
    ("the paper advises", lambda row: row.advised and row.advised.tolerance),
    ("limits kept there", lambda row: row.advised and _kept(row.advised)),
)
_FILE: _Columns = (
    ("its range", lambda row: row.certified),
    ("as stated", lambda row: row.stated),
    ("limits kept as stated", lambda row: row.advised and _kept(row.advised)),
)
_UNCERTAIN: _Columns = (
    ("other constants", lambda row: row.constants and extent(row.constants)),
    ("with model error", lambda row: row.model and value(row.model)),
    ("worst constants, model error", lambda row: row.both and value(row.both)),
)
_STRATA = {
    "above": "above a limit in the surrogate",
    "near": "at least {:.0%} of a limit",
    "far": "less than {:.0%} of every limit",
}
_SHARES = (
    "Cases above a limit in the surrogate count as above. At most: upper bound of the share above in "
    "the reference (Clopper and Pearson); the error probabilities of all bounds add up."
)


def figures(found: Limits) -> list[Figure]:
    """Each figure with its caption."""
    # a logarithmic axis has no place for a tolerance of zero
    drawn = [row for row in found.rows if any(size > 0.0 for size, _ in row.nominal.trials)]
    shown = []
    if drawn:
        panels = [_panel(row, found) for row in drawn]
        caption = _CURVES.format(known=_known(found), **vars(found))
        shown.append(Figure(lambda: Chart("limits-curves", panels, columns=3, height=260), caption))
    if pair := found.map:
        shown.append(Figure(lambda: _map(pair, found.probability), _MAP))
    return shown


def draw(found: Limits) -> list[Part]:
    """The certified tolerances with their check, figures, and every quantity there."""
    run = (
        f"limits: {', '.join(limit.words for limit in found.limits)}; to be kept together with probability "
        f"{found.probability:g} at {found.confidence:.0%} confidence; {found.cases:,} cases"
    )
    odd = [f"{row.words}: {line}" for row in found.rows for line in _odd(row)]
    return [
        Bullets([run, population.model_line(found), *_certified(found), *odd]),
        table_of(found),
        *([] if found.certificate is None else [_strata(found.certificate)]),
        *figures(found),
        *_beside(found),
        *([_ADVICE] if found.asked.vary is None else []),
    ]


def _known(found: Limits) -> str:
    """What a tolerance is compared with."""
    return "the advice of the paper" if found.asked.vary is None else "as stated in the file"


def table_of(found: Limits) -> Table:
    """One row for each factor, without the columns that are empty in all rows."""
    vary = found.asked.vary
    columns = (*_FIRST, *(_PAPER if vary is None else _FILE), *_UNCERTAIN)
    shown = [column for column in columns if any(column[1](row) is not None for row in found.rows)]
    others = "as in the scene" if found.asked.others == "scene" else "zero"
    notes = (
        (_TOLERANCE if vary is None else _OF_FILE).format(others=others, vary=vary),
        _CERTIFIED.format(most=1.0 - found.probability, **vars(found)),
        _uncertain(found),
    )
    return Table.of_records(found.rows, *shown, notes=notes)


def _uncertain(found: Limits) -> str:
    """The source of both uncertainties."""
    constants, margin = found.constants, found.margin
    drawn = (
        f"the search is repeated for {counted(constants.draws, 'draw')} of {', '.join(constants.drawn)} "
        "from their 95 % intervals"
        if constants.draws
        else "not drawn, since none is fitted or has an interval"
    )
    sizes = ", ".join(f"{axis} {size:.2g}" for axis, size in (margin.deg_s or {}).items())
    error = f"{sizes} deg/s, " if sizes else ""
    return (
        f"Other constants: {drawn}. Model error, which reduces every limit: {error}{margin.said}."
    )


def _certified(found: Limits) -> list[str]:
    """The result of the runs of the reference, in sentences; empty if they were not requested."""
    if found.asked.certify is None:
        return []
    if (shown := found.certificate) is None:
        return ["no tolerance of the whole set is certified, so the reference has nothing to check"]
    multiple = next(row for row in found.rows if row.name == TOGETHER).nominal.tolerance
    runs = sum(each.runs for each in shown.strata)
    lines = [
        f"finite elements of {1e3 * shown.element_size_m:g} mm, {runs} runs at {multiple:.3g} "
        "times the set: a rate is above its limit with a probability of at most "
        f"{percent(shown.upper)} % ({found.confidence:.0%} confidence), estimate "
        f"{percent(shown.estimate)} %; allowed are {percent(1.0 - found.probability)} %: "
        f"{'certified' if shown.certified else 'not certified'}",
        "the same number of runs without strata, none of them above a limit, would give at most "
        f"{percent(shown.plain)} %",
    ]
    if not shown.certified:
        lines.append(
            "too many cases of the surrogate are above a limit for any number of runs: make the tolerances "
            "smaller"
            if shown.needed is None
            else f"{shown.needed:,} runs would certify it, if no further run is above a limit"
        )
    if shown.lost:
        lost = "; ".join(each.words for each in shown.lost)
        lines.append(f"not settled in the reference, counted as above: {lost}")
    return lines


def _strata(shown: Certificate) -> Table:
    """The check by the reference."""
    most = {"above": None, "near": percent(shown.near_share), "far": percent(shown.far_share)}

    def words(each: Stratum) -> str:
        return _STRATA[each.name].format(shown.near)

    return Table.of_records(
        shown.strata,
        ("cases", words),
        ("in the surrogate", attrgetter("cases")),
        ("runs of the reference", attrgetter("runs")),
        ("above", attrgetter("events")),
        ("at most (%)", lambda each: most[each.name]),
        notes=(_SHARES,),
        title="Check by the reference",
    )


def _unit(unit: str, form: str = " {}") -> str:
    return "" if unit == "1" else form.format(unit)


def _kept(advised: Advised) -> str:
    """Bounds of the share of cases within the limits."""
    return span(100.0 * (1.0 - advised.high), 100.0 * (1.0 - advised.low), ".4g") + " %"


def _odd(row: CertifiedFactor) -> list[str]:
    """The tolerances between which the number of cases above a limit does not grow."""
    unit, lines = _unit(row.unit), []
    if row.nominal.again:
        sizes = ", ".join(f"{size:.3g}" for size in row.nominal.again)
        lines.append(f"also certified beyond the first failure, not used: {sizes}{unit}")
    if row.nominal.falls:
        ends = ", ".join(f"{one:.3g} to {two:.3g}" for one, two in row.nominal.falls)
        lines.append(
            f"the number of cases above a limit falls with the tolerance from {ends}{unit}"
        )
    return lines


def value(found: Found) -> float | str | None:
    """The largest certified tolerance, or the reason why there is none."""
    if found.state == FOUND:
        return found.tolerance
    if found.state == ALL:
        return f"all searched, up to {found.tolerance:.3g}"
    if found.state == SMALL:
        return f"less than {found.fails:.2g}"
    return _REASONS[found.state]


def extent(searches: Sequence[Found]) -> str:
    """Smallest and largest of several tolerances, and how many searches found none."""
    sizes = [each.tolerance for each in searches if each.tolerance is not None]
    missing = len(searches) - len(sizes)
    none = f", none in {missing} of {len(searches)}" if missing else ""
    return (span(min(sizes), max(sizes)) if sizes else "none") + none


def _beside(found: Limits) -> list[Part]:
    """Every quantity at the certified tolerances."""
    rows = [(row.words, row.beside) for row in found.rows if row.beside]
    if not rows:
        return []
    quantities = [Column(item.label, item.unit) for item in rows[0][1]]
    body = [(words, *map(estimate, beside)) for words, beside in rows]
    note = (
        f"The magnitude that {found.probability:.4%} of the cases stay below, with its 95 % bounds."
    )
    table = Table(["at the certified tolerance of", *quantities], body, notes=(note,), dense=True)
    return [Fold("Every quantity at the certified tolerances", [table])]


def _panel(row: CertifiedFactor, found: Limits) -> Panel:
    """Share above a limit over the tolerance. A share of zero is not drawn, since the axis is
    logarithmic; its upper bound is."""
    trials = [trial for trial in row.nominal.trials if trial.tolerance > 0.0]
    sizes = [size for size, _ in trials]
    seen = [(size, count / found.cases) for size, count in trials if count > 0]
    shares = [share for _, share in seen]
    upper = [exceedance.at_most(count, found.cases, found.confidence) for _, count in trials]
    ends = [min(upper + shares), 1.0]
    lines = [
        Line([size for size, _ in seen], shares, "share of cases above", marker="o", size=5.0),
        Line(sizes, upper, "its upper bound", TEAL, dash=":"),
        Line([sizes[0], sizes[-1]], [1.0 - found.probability] * 2, "1 - p", GREY, 1.2, "-."),
    ]
    if (most := row.nominal.tolerance) is not None:
        lines.append(Line([most] * 2, ends, "largest certified", VERMILION, 1.8))
    if row.advised and sizes[0] <= (advice := row.advised.tolerance) <= sizes[-1]:
        lines.append(Line([advice] * 2, ends, _known(found), AMBER, 1.8, "--"))
    title = row.words.partition(",")[0]
    unit = (
        "times the set"
        if row.name == TOGETHER
        else "dimensionless"
        if row.unit == "1"
        else row.unit
    )
    return Panel(title, f"tolerance ({unit})", "share above a limit", lines, log=True)


def _map(shown: Map, probability: float) -> Chart:
    x, y = zip(*(point.tolerances for point in shown.points))
    (at_x, at_y), advised = shown.advised, "advised by the paper"
    certified = f"largest certified pairs, p = {probability:g}"
    lines = [
        Line(x, y, certified, width=1.8, marker="o", size=7.0),
        marks([at_x], [at_y], advised, VERMILION, "s", size=10.0),
    ]
    across, up = (f"tolerance of {name} ({unit})" for name, unit in zip(shown.words, shown.units))
    return Chart("limits-map", [Panel("", across, up, lines)], height=380)
