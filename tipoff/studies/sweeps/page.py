"""How large an error may be, on the page: verdicts beside the paper's, why there is a plateau or
none, and the figures."""

from collections.abc import Callable

from tipoff.studies.populations import answers
from tipoff.studies.render.chart import Chart, Picture
from tipoff.studies.render.markup import Html, caption, fold, number, paragraph, percent, table
from tipoff.studies.sweeps.figures import pictures
from tipoff.studies.sweeps.knee import LEVEL, MISFIT

_SHORT = {"rate_x_deg_s": "x", "rate_y_deg_s": "y", "rate_z_deg_s": "z", "rate_deg_s": "total"}
_RUN = (
    "thrust, times as long",
    "cases",
    "did not settle",
    "exit (ms)",
    "impulse after the exit (%)",
)
_VERDICT = (
    "error",
    "leaves the free line at",
    "about",
    "verdict",
    "knee",
    "95 %",
    "the paper",
    "slope before",
    "after",
    "misfit (%)",
    "plateau in resamples (%)",
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


def draw(found: dict, figure: Callable[[Chart | Picture, str], Html]) -> Html:
    """The section: what was run, verdicts, why, then figures."""
    parts = [_counts(found["launches"])]
    for launch in found["launches"]:
        parts += [Html(f"<h3>{_title(launch)}</h3>"), _verdicts(launch), _largest(launch)]
    parts += [caption(_METHOD), _why(found["launches"])]
    return Html("".join([*parts, *(figure(*item) for item in pictures(found))]))


def _title(launch: dict) -> str:
    if launch["stretch"] == 1.0:
        return "The launcher as given"
    return f"Its thrust {launch['stretch']:g} times as long, with the same impulse"


def _counts(launches: list[dict]) -> Html:
    return table(
        _RUN,
        [
            (
                f"{item['stretch']:g}",
                f"{item['cases']['asked']:,}",
                f"{item['not_settled']:,}",
                number(item["exit_s"] and 1e3 * item["exit_s"]),
                percent(item["share_after_exit"], 2),
            )
            for item in launches
        ],
    )


def _verdicts(launch: dict) -> Html:
    return table(
        _VERDICT,
        [
            _verdict(factor, name, bent)
            for factor in launch["factors"]
            for name, bent in factor["growth"].items()
            if bent
        ],
        dense=True,
    )


def _verdict(factor: dict, name: str, bent: dict) -> tuple:
    ends = None if bent["low"] is None else f"{bent['low']:.2f} to {bent['high']:.2f}"
    return (
        f"{factor['label']} ({factor['unit']})",
        number(factor["departs_from_free_at"]),
        _SHORT[name],
        bent["verdict"],
        number(bent["knee"]),
        ends,
        f"{factor['paper']:g}",
        number(bent["slope_before"]),
        number(bent["slope_after"]),
        percent(bent["misfit"], 2),
        percent(bent["plateau_share"], 2),
    )


def _largest(launch: dict) -> Html:
    """Every quantity at every size, in magnitude."""
    parts = []
    for factor in launch["factors"]:
        rows = [
            (f"{item.label} ({item.unit})", *map(number, factor["largest"][item.name]))
            for item in answers.ALL
        ]
        heads = (
            f"{factor['label']} ({factor['unit']})",
            *(f"{size:g}" for size in factor["sizes"]),
        )
        parts.append(table(heads, rows, dense=True))
    return fold(
        "largest value of every quantity by size",
        *parts,
        caption("Largest magnitude over all directions that settled."),
    )


def _why(launches: list[dict]) -> Html:
    """What the two launches show together, on misalignment, which is the error with a plateau in
    the paper and the first here."""
    if len(launches) < 2 or launches[0]["share_after_exit"] is None:
        return Html("")
    held, freed = sorted(launches, key=lambda item: item["share_after_exit"])
    rises = [
        _late_rise(launch["factors"][0]["largest"]["rate_y_deg_s"]) for launch in (held, freed)
    ]
    free = _late_rise(freed["factors"][0]["free"]["rate_y_deg_s"])
    after = None if free is None else freed["share_after_exit"] * free
    return Html(
        "".join(
            [
                paragraph(_REASON),
                paragraph(
                    f"Here: with {percent(held['share_after_exit'], 2)} % of the impulse after the "
                    f"exit the largest rate about y changes by "
                    f"{number(rises[0])} deg/s over the upper half of sizes of the "
                    f"{held['factors'][0]['label']}; with "
                    f"{percent(freed['share_after_exit'], 2)} % it changes by {number(rises[1])} "
                    f"deg/s, and the moment after the exit alone "
                    f"gives {number(after)}."
                ),
            ]
        )
    )


def _late_rise(values: list[float | None]) -> float | None:
    """Change over the upper half of the sizes."""
    first, last = values[len(values) // 2 - 1], values[-1]
    return None if first is None or last is None else last - first
