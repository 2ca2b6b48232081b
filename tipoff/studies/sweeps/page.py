"""How large an error may be, on the page and for the terminal: verdicts beside the paper's, the
reason for a plateau, and the figures."""

from tipoff.studies.populations import answers, population
from tipoff.studies.render.document import Bullets, Caption, Fold, Heading, Part
from tipoff.studies.render.table import Cells, Column, Noted, Table, number, percent, span
from tipoff.studies.sweeps.figures import figures
from tipoff.studies.sweeps.knee import LEVEL, MISFIT

_SHORT = {"rate_x_deg_s": "x", "rate_y_deg_s": "y", "rate_z_deg_s": "z", "rate_deg_s": "total"}
_RUN: Cells = (
    (Column("thrust, times as long", form="g"), "stretch"),
    ("cases", lambda launch: launch["cases"]["asked"]),
    ("did not settle", "not_settled"),
    (Column("exit", "ms", scale=1e3), "exit_s"),
    (Column("impulse after the exit", "%", ".2g", 100.0), "share_after_exit"),
)
_VERDICT = (
    "error",
    Column("the paper", form="g"),
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
    "The paper: the size at which its plateau begins. The interval of a knee is a bootstrap over "
    "directions. Plateau: the share of the resamples with this verdict."
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


def draw(found: dict) -> list[Part]:
    """The section: runs, verdicts, the reason for a plateau, figures."""
    launches = found["launches"]
    parts = _runs(found)
    for launch in launches:
        parts += [
            Heading(_title(launch)),
            table_of_verdicts(launch),
            table_of_largest(launch),
            Fold("Slopes, and the largest values by size", _details(launch)),
        ]
    return [*parts, Caption(_METHOD), *_why(launches), *figures(found)]


def terminal(found: dict) -> list[Part]:
    """Runs, verdicts and the largest values, for the terminal."""
    parts = _runs(found)
    for launch in found["launches"]:
        parts += [Heading(_title(launch)), table_of_verdicts(launch), table_of_largest(launch)]
    return parts


def _runs(found: dict) -> list[Part]:
    return [Bullets([population.model_line(found)]), Table.of(found["launches"], _RUN)]


def _title(launch: dict) -> str:
    if launch["stretch"] == 1.0:
        return "The launcher as given"
    return f"With a thrust {launch['stretch']:g} times as long and the same impulse"


def table_of_verdicts(launch: dict) -> Table:
    """Verdict of each rate over the sizes of an error, beside that of the paper."""
    rows = [
        (
            *_error(factor, name, factor["paper"]),
            _SHORT[name],
            bent["verdict"],
            None
            if bent["knee"] is None
            else Noted(bent["knee"], span(bent["low"], bent["high"], ".2f")),
            bent["misfit"],
            bent["plateau_share"],
        )
        for factor, name, bent in _judged(launch)
    ]
    return Table(_VERDICT, rows, (_INTERVAL,))


def _slopes(launch: dict) -> Table:
    rows = [
        (
            *_error(factor, name, factor["departs_from_free_at"]),
            _SHORT[name],
            bent["slope_before"],
            bent["slope_after"],
        )
        for factor, name, bent in _judged(launch)
    ]
    return Table(_SLOPES, rows, (_FREE,), dense=True)


def _judged(launch: dict) -> list[tuple[dict, str, dict]]:
    """Factor, name of the rate, and its growth."""
    return [
        (factor, name, bent)
        for factor in launch["factors"]
        for name, bent in factor["growth"].items()
        if bent
    ]


def _error(factor: dict, name: str, size: float | None) -> tuple:
    """Label and a size of a factor, in the first of its rows alone."""
    first = next(key for key, bent in factor["growth"].items() if bent)
    return (f"{factor['label']} ({factor['unit']})", size) if name == first else ("", "")


def table_of_largest(launch: dict) -> Table:
    """The largest magnitude of every quantity over sizes and directions."""
    factors = launch["factors"]
    rows = [
        (
            f"{item.label} ({item.unit})",
            *(
                max(
                    (value for value in factor["largest"][item.name] if value is not None),
                    default=None,
                )
                for factor in factors
            ),
        )
        for item in answers.ALL
    ]
    note = "Largest magnitude of the settled cases, over all sizes and directions."
    return Table(["largest", *(factor["label"] for factor in factors)], rows, (note,))


def _details(launch: dict) -> list[Part]:
    """Slopes, and every quantity at every size, in magnitude."""
    tables: list[Part] = [
        Table(
            [f"{factor['label']} ({factor['unit']})", *(f"{size:g}" for size in factor["sizes"])],
            [
                (f"{item.label} ({item.unit})", *factor["largest"][item.name])
                for item in answers.ALL
            ],
            dense=True,
        )
        for factor in launch["factors"]
    ]
    note = Caption("Largest magnitude of the settled cases, over all directions.")
    return [_slopes(launch), *tables, note]


def _why(launches: list[dict]) -> list[Part]:
    """The reason for a plateau, with the numbers of both launches for the first error."""
    if len(launches) < 2 or launches[0]["share_after_exit"] is None:
        return []
    held, freed = sorted(launches, key=lambda item: item["share_after_exit"])
    rises = [
        _late_rise(launch["factors"][0]["largest"]["rate_y_deg_s"]) for launch in (held, freed)
    ]
    free = _late_rise(freed["factors"][0]["free"]["rate_y_deg_s"])
    after = None if free is None else freed["share_after_exit"] * free
    return [
        _REASON,
        f"Over the upper half of the sizes of the {held['factors'][0]['label']}, the largest rate "
        f"about y changes by {number(rises[0])} deg/s with "
        f"{percent(held['share_after_exit'], '.2g')} % of the impulse after the exit, and by "
        f"{number(rises[1])} deg/s with {percent(freed['share_after_exit'], '.2g')} %. The moment "
        f"after the exit alone gives {number(after)} deg/s.",
    ]


def _late_rise(values: list[float | None]) -> float | None:
    """Change over the upper half of the sizes."""
    first, last = values[len(values) // 2 - 1], values[-1]
    return None if first is None or last is None else last - first
