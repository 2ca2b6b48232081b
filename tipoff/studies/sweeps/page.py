"""How large an error may be, on the page: verdicts beside the paper's, why there is a plateau or
none, and the figures."""

from tipoff.studies.populations import answers
from tipoff.studies.render.document import Caption, Figure, Fold, Heading, Part
from tipoff.studies.render.table import Column, Table, number, percent, span
from tipoff.studies.sweeps.figures import pictures
from tipoff.studies.sweeps.knee import LEVEL, MISFIT

_SHORT = {"rate_x_deg_s": "x", "rate_y_deg_s": "y", "rate_z_deg_s": "z", "rate_deg_s": "total"}
_RUN = (
    Column("thrust, times as long", form="g"),
    "cases",
    "did not settle",
    Column("exit", "ms", scale=1e3),
    Column("impulse after the exit", "%", ".2g", 100.0),
)
_VERDICT = (
    "error",
    "leaves the free line at",
    "about",
    "verdict",
    "knee",
    "95 %",
    Column("the paper", form="g"),
    "slope before",
    "after",
    Column("misfit", "%", ".2g", 100.0),
    Column("plateau in resamples", "%", ".2g", 100.0),
)
_METHOD = (
    "A law is chosen by its corrected information criterion; the interval of a knee is 95 %, a "
    "bootstrap over directions. "
    f"Plateau: beyond the knee the rate stays within {100.0 * LEVEL:g} % of its value there. "
    f"Levels off: at the largest "
    f"size no more than {100.0 * LEVEL:g} % of the height is left to grow. None of the laws: the "
    f"best one misses by more "
    f"than {100.0 * MISFIT:g} % of the largest rate (rms). The free line is that of a payload no "
    f"rail holds; the size is "
    "the first at which a total rate is 5 % off it."
)
_REASON = (
    "Why there may be a plateau: an error turns the payload by its moment until the clearance "
    "stops it, and from there a "
    "larger moment only presses harder. Where the thrust burns out on the rail, what the touches "
    "left of the rate is all "
    "there is, and a larger error adds little until it makes other pads touch. Where the payload "
    "leaves while the thrust "
    "still acts, no wall stops it any more: the impulse J' that is left adds the rate J' r/I, in "
    "proportion to the error, "
    "and no plateau can outlive that."
)


def draw(found: dict) -> list[Part]:
    """The section: what was run, verdicts, why, then figures."""
    launches = found["launches"]
    parts: list[Part] = [_counts(launches)]
    for launch in launches:
        parts += [Heading(_title(launch)), _verdicts(launch), _largest(launch)]
    figures = [Figure(*item) for item in pictures(found)]
    return [*parts, Caption(_METHOD), *_why(launches), *figures]


def _title(launch: dict) -> str:
    if launch["stretch"] == 1.0:
        return "The launcher as given"
    return f"Its thrust {launch['stretch']:g} times as long, with the same impulse"


def _counts(launches: list[dict]) -> Table:
    return Table(
        _RUN,
        [
            (
                item["stretch"],
                item["cases"]["asked"],
                item["not_settled"],
                item["exit_s"],
                item["share_after_exit"],
            )
            for item in launches
        ],
    )


def _verdicts(launch: dict) -> Table:
    rows = [
        _verdict(factor, name, bent)
        for factor in launch["factors"]
        for name, bent in factor["growth"].items()
        if bent
    ]
    return Table(_VERDICT, rows, dense=True)


def _verdict(factor: dict, name: str, bent: dict) -> tuple:
    return (
        f"{factor['label']} ({factor['unit']})",
        factor["departs_from_free_at"],
        _SHORT[name],
        bent["verdict"],
        bent["knee"],
        span(bent["low"], bent["high"], ".2f"),
        factor["paper"],
        bent["slope_before"],
        bent["slope_after"],
        bent["misfit"],
        bent["plateau_share"],
    )


def _largest(launch: dict) -> Fold:
    """Every quantity at every size, in magnitude."""
    parts: list[Part] = [
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
    note = Caption("Largest magnitude over all directions that settled.")
    return Fold("largest value of every quantity by size", [*parts, note])


def _why(launches: list[dict]) -> list[Part]:
    """What the two launches show together, on misalignment, which is the error with a plateau in
    the paper and the first here."""
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
        f"Here: with {percent(held['share_after_exit'], '.2g')} % of the impulse after the exit "
        f"the largest rate about y changes by {number(rises[0])} deg/s over the upper half of "
        f"sizes of the {held['factors'][0]['label']}; with "
        f"{percent(freed['share_after_exit'], '.2g')} % it changes by {number(rises[1])} deg/s, "
        f"and the moment after the exit alone gives {number(after)}.",
    ]


def _late_rise(values: list[float | None]) -> float | None:
    """Change over the upper half of the sizes."""
    first, last = values[len(values) // 2 - 1], values[-1]
    return None if first is None or last is None else last - first
