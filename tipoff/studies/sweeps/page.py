"""How large an error may be: verdicts, the reason for a plateau, and the figures."""

from collections.abc import Iterator, Sequence

from tipoff.scenes import halving
from tipoff.studies.populations import answers, population
from tipoff.studies.render.document import Bullets, Caption, Fold, Heading, Part
from tipoff.studies.render.table import Column, Noted, Table, number, percent, span
from tipoff.studies.sweeps.figures import figures
from tipoff.studies.sweeps.knee import LEVEL, MISFIT, Growth
from tipoff.studies.sweeps.results import Curve, Launch, Sweeps, Swept

_SHORT = {"rate_x_deg_s": "x", "rate_y_deg_s": "y", "rate_z_deg_s": "z", "rate_deg_s": "total"}
_VERDICT = (
    "error",
    "rate",
    "verdict",
    "knee, 95 % interval",
    Column("misfit", "%", ".2g", 100.0),
    Column("plateau", "%", ".2g", 100.0),
)
_SLOPES = ("error", "not free from", "rate", "slope before", "slope after")
_METHOD = (
    "The corrected information criterion selects the law. Plateau: beyond the knee the rate "
    f"stays within {100.0 * LEVEL:g} % of its value there. Levels off: at the largest size, at "
    f"most {100.0 * LEVEL:g} % of the height is left to grow. None of the laws: the best law has "
    f"a misfit (rms) above {100.0 * MISFIT:g} % of the largest rate."
)
_INTERVAL = (
    "The interval of a knee is a bootstrap over directions. Plateau: the share of the resamples with "
    "this verdict."
)
_FREE = (
    "Not free from: the first size at which a total rate differs by 5 % from that of a free "
    "payload. Slopes in deg/s per unit of the error."
)
_REASON = (
    "Reason for a plateau: an error turns the payload until the clearance stops it. A larger "
    "moment then only increases the pressure. If the thrust burns out on the rail, a larger "
    "error adds little to the rate until other pads touch. If the payload leaves under thrust, "
    "no wall limits the rest: the remaining impulse J' adds the rate J' r/I. It is proportional "
    "to the error, so there is no plateau."
)


def draw(found: Sweeps) -> list[Part]:
    """The section: runs, verdicts, the reason for a plateau, figures."""
    parts = _runs(found)
    for launch in found.launches:
        details = Fold("Slopes, and the largest values by size", _details(launch))
        parts += [*_launched(launch), details]
    return [*parts, Caption(_METHOD), *_why(found.launches), *figures(found)]


def _runs(found: Sweeps) -> list[Part]:
    names = ("not_settled", "exit_s", "share_after_exit")
    cases = ("cases", lambda launch: launch.cases["asked"])
    table = Table.of_records(found.launches, "stretch", cases, *names)
    lines = [population.model_line(found)]
    if found.asked.vary is not None:
        lines.append(
            f"errors of {found.asked.vary}, each alone in every direction, up to the size that 99.9 % of its "
            "draws stay below"
        )
    if found.held:
        lines.append(
            "not swept, and as in the scene in each case, because only offsets of thrust and mass are swept: "
            f"{halving.listed(found.held)}. tipoff ensemble --halve varies all errors together, and says what "
            "each one does"
        )
    return [Bullets(lines), table]


def _launched(launch: Launch) -> list[Part]:
    title = (
        "The launcher as given"
        if launch.stretch == 1.0
        else f"With a thrust {launch.stretch:g} times as long and the same impulse"
    )
    return [Heading(title), table_of_verdicts(launch), table_of_largest(launch)]


def table_of_verdicts(launch: Launch) -> Table:
    """Verdict of each rate over the sizes of an error."""
    rows = [
        (
            factor.title if first else "",
            rate,
            bent.verdict,
            None if bent.knee is None else Noted(bent.knee, span(bent.low, bent.high, ".2f")),
            bent.misfit,
            bent.plateau_share,
        )
        for factor, first, rate, bent in _judged(launch)
    ]
    return Table(_VERDICT, rows, notes=(_INTERVAL,))


def _judged(launch: Launch) -> Iterator[tuple[Swept, bool, str, Growth]]:
    """Factor, whether the rate is the first of the factor, the rate, and its growth."""
    for factor in launch.factors:
        judged = [(name, bent) for name, bent in factor.growth.items() if bent]
        for name, bent in judged:
            yield factor, name == judged[0][0], _SHORT[name], bent


def table_of_largest(launch: Launch) -> Table:
    """The largest magnitude of every quantity over sizes and directions."""

    def most(curve: Curve) -> float | None:
        return max((value for value in curve if value is not None), default=None)

    rows = [
        (item.title, *(most(factor.largest[item.name]) for factor in launch.factors))
        for item in answers.ALL
    ]
    ends = ", ".join(f"{item.label} {item.sizes[-1]:g} {item.unit}" for item in launch.factors)
    note = f"Largest magnitude of the cases that leave, over all directions and all sizes up to: {ends}."
    return Table(["largest", *(item.label for item in launch.factors)], rows, notes=(note,))


def _details(launch: Launch) -> list[Part]:
    """Slopes, and the magnitude of every quantity at every size."""
    slopes = [
        (
            *((factor.title, factor.departs_from_free_at) if first else ("", "")),
            rate,
            bent.slope_before,
            bent.slope_after,
        )
        for factor, first, rate, bent in _judged(launch)
    ]
    tables = [
        Table(
            [factor.title, *(f"{size:g}" for size in factor.sizes)],
            [(item.title, *factor.largest[item.name]) for item in answers.ALL],
            dense=True,
        )
        for factor in launch.factors
    ]
    note = Caption("Largest magnitude of the cases that leave, over all directions.")
    return [Table(_SLOPES, slopes, notes=(_FREE,), dense=True), *tables, note]


def _why(launches: Sequence[Launch]) -> list[Part]:
    """The reason for a plateau, with the numbers of both launches for the first error."""
    if len(launches) < 2 or launches[0].share_after_exit is None:
        return []
    held, freed = sorted(launches, key=lambda launch: launch.share_after_exit or 0.0)
    rises = [_late_rise(launch.factors[0].largest["rate_y_deg_s"]) for launch in (held, freed)]
    free = _late_rise(freed.factors[0].free["rate_y_deg_s"])
    share = freed.share_after_exit
    after = None if free is None or share is None else share * free
    return [
        _REASON,
        f"Over the upper half of the sizes of the {held.factors[0].label}, the largest rate "
        f"about y changes by {number(rises[0])} deg/s with "
        f"{percent(held.share_after_exit, '.2g')} % of the impulse after the exit, and by "
        f"{number(rises[1])} deg/s with {percent(share, '.2g')} %. The moment "
        f"after the exit alone gives {number(after)} deg/s.",
    ]


def _late_rise(values: Curve) -> float | None:
    """Change over the upper half of the sizes."""
    first, last = values[len(values) // 2 - 1], values[-1]
    return None if first is None or last is None else last - first
