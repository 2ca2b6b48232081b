"""The answer of the scene itself: the first figures of the page and of the terminal."""

import math
from typing import TYPE_CHECKING

from tipoff.mechanics import instant
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS
from tipoff.mechanics.run_limits import EXIT_WINDOW, SETTLE_WINDOW
from tipoff.results.model_error import Range as NeighbourRange
from tipoff.scenes import halving
from tipoff.studies.nominal.spread import QUANTITIES, SPEED, Range, Spread
from tipoff.studies.populations.answers import RATES, TOTAL_RATE, Quantity
from tipoff.studies.render.document import Bullets, KeyFigures, Part
from tipoff.uncertain import LEAST, SHARE, STEPS, number, range_of, rounded
from tipoff.workspace.words import counted

if TYPE_CHECKING:
    from tipoff.studies.nominal.stage import Nominal

_MEANINGS = {
    "rate_x_deg_s": "rate about X, roll",
    "rate_y_deg_s": "rate about Y",
    "rate_z_deg_s": "rate about Z",
    "velocity_x_m_s": "velocity along X",
    "exit_time_ms": "exit after ignition",
}
_NO_ERRORS = (
    "The scene states no random errors, so no range is known. State them in its table [studies]: "
    'errors = "paper" for those of the paper\'s Table 3, or a file of distributions'
)


def draw(found: "Nominal") -> list[Part]:
    """The values with their ranges in large type, and their explanation."""
    return [KeyFigures(figures(found)), Bullets(notes(found))]


def figures(found: "Nominal") -> list[tuple[str, str]]:
    """(value with its unit, meaning and range) of each quantity."""
    return [
        (
            f"{_shown(item, found)} {item.unit}" if _values(found) else "–",
            _meaning(item) + _under(found.spread, item),
        )
        for item in QUANTITIES
    ]


def _meaning(item: Quantity) -> str:
    return _MEANINGS.get(item.name, item.label)


def _values(found: "Nominal") -> dict[str, float] | None:
    """The values of the finite elements, or of the surrogate if these did not settle."""
    return found.answer[FINITE_ELEMENTS] or found.answer[COMPLIANT]


def _shown(item: Quantity, found: "Nominal") -> str:
    """The value as text, rounded to its range, or without a range to the difference of both models."""
    values = _values(found)
    assert values is not None
    least = STEPS.get(item.unit, LEAST)
    if (own := _neighbours(found)) is not None and (over := _over(own, item)) is not None:
        return range_of(*over, least=least)
    if (ends := _ends(found.spread, item)) is not None:
        return rounded(values[item.name], SHARE * (ends.high - ends.low), least)
    both = [answer[item.name] for answer in found.answer.values() if answer]
    apart = max(both) - min(both) if len(both) > 1 else None
    return rounded(values[item.name], apart, least)


def _neighbours(found: "Nominal") -> NeighbourRange | None:
    """The range of the scene itself over its neighbours, which stands for its values if it is sensitive."""
    return next((row.range for row in found.rows if row.range is not None), None)


def _over(own: NeighbourRange, item: Quantity) -> tuple[float, float] | None:
    """Both ends of a quantity over the neighbours; None for one that they do not have."""
    if item.name == SPEED.name:
        return own.low_m_s[0], own.high_m_s[0]
    if item.name == TOTAL_RATE.name:
        return own.within(lambda rates: math.hypot(*rates))
    axes = [axis for axis, rate in enumerate(RATES) if rate.name == item.name]
    return (own.low_deg_s[axes[0]], own.high_deg_s[axes[0]]) if axes else None


def _ends(spread: Spread | None, item: Quantity) -> Range | None:
    """The range of a quantity; None if it has none."""
    return None if spread is None or spread.ranges is None else spread.ranges[item.name]


def _under(spread: Spread | None, item: Quantity) -> str:
    ends = _ends(spread, item)
    return f"; 95 % of launches: {_text(ends)} {item.unit}" if ends else ""


def _text(ends: Range) -> str:
    return range_of(ends.low, ends.high)


def notes(found: "Nominal") -> list[str]:
    """Sentences on the values, the difference of both models, and the range."""
    reference, surrogate = (found.answer[name] for name in (FINITE_ELEMENTS, COMPLIANT))
    statuses = {row.model: row.status for row in found.rows}
    of = "finite elements" if reference else "compliant contact" if surrogate else ""
    if not of:
        words = ", ".join(f"{model}: {status}" for model, status in statuses.items())
        ends = "leave" if found.at == instant.EXIT else "settle"
        said = [f"The scene itself does not {ends} ({words})"]
    else:
        said = [
            f"The scene itself, by {of}: means {_when(found)}, rates inertial in payload body axes, "
            "velocity in the initial scene axes"
        ]
    own = _neighbours(found)
    if own is not None:
        said.append(
            f"The scene itself is sensitive: its rates and velocity are the range of {own.runs} runs within 1 µm of "
            "clearance by compliant contact, with no single value"
        )
    elif reference and surrogate:
        apart = max(abs(reference[item.name] - surrogate[item.name]) for item in RATES)
        said.append(f"Compliant contact differs by at most {number(apart, '.2g', LEAST)} deg/s")
    elif of:
        failed = COMPLIANT if reference else FINITE_ELEMENTS
        said.append(f"The run of {failed} did not settle: {statuses[failed]}")
    return [*said, *_of_spread(found.spread)]


def _when(found: "Nominal") -> str:
    if found.at == instant.EXIT:
        return f"over {1e3 * EXIT_WINDOW:g} ms after the exit, {found.at_why}"
    return f"over {1e3 * SETTLE_WINDOW:g} ms after exit and burnout"


def _of_spread(spread: Spread | None) -> list[str]:
    if spread is None:
        return [_NO_ERRORS]
    cases, lost = spread.cases, spread.cases - spread.settled
    stated = halving.with_sizes(spread.errors, spread.sizes)
    errors = f"{cases:,} launches of compliant contact with the errors {stated}"
    if spread.ranges is None:
        return [f"No range: {counted(spread.settled, 'case')} of {errors} settled"]
    at = f", {instant.where(spread.at)}" if spread.at == instant.EXIT else ""
    said = [f"95 % of launches: between the 2.5 and 97.5 % quantiles of {errors}{at}"]
    if lost:
        said.append(
            f"{lost:,} of them, {number(100.0 * lost / cases, '.2g')} %, did not leave and settle; "
            "the range is that of the others"
        )
    known = max(spread.ranges[item.name].doubt for item in (TOTAL_RATE, *RATES))
    said.append(
        f"The ends of the rates are known to ± {max(1, math.ceil(100.0 * known))} % of the range or better"
        if math.isfinite(known)
        else "Too few cases settled to bound the ends"
    )
    return said


def ranges(spread: Spread | None) -> list[Part]:
    """The 95 % range of each quantity alone, and its explanation."""
    own = [
        (f"{_text(ends)} {item.unit}", f"95 % range, {_meaning(item)}")
        for item in QUANTITIES
        if (ends := _ends(spread, item)) is not None
    ]
    return [KeyFigures(own), Bullets(_of_spread(spread))]
