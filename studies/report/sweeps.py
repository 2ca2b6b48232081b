"""How large an error may be, on the page: verdicts beside the paper's, why there is a plateau or none, and the figures."""

from typing import Callable

from studies.knee import LEVEL, MISFIT
from studies.report.chart import Chart
from studies.report.markup import Html, caption, number, paragraph, percent, table
from studies.report.sweep_figures import pictures

_SHORT = {"rate_x_deg_s": "x", "rate_y_deg_s": "y", "rate_z_deg_s": "z", "rate_deg_s": "total"}


def draw(found: dict, figure: Callable[[Chart, str], Html]) -> Html:
    """The section: what was run, verdicts, why, then figures."""
    parts = [_counts(found["launches"])]
    for launch in found["launches"]:
        parts += [Html(f"<h3>{_title(launch)}</h3>"), _verdicts(launch)]
    parts += [caption(f"A law is chosen by its corrected information criterion; with a knee the interval is 95 %, a bootstrap over directions. Plateau: beyond the knee the "
                      f"rate stays within {percent(LEVEL)} % of its value there. No law: the best one misses by more than {percent(MISFIT)} % of the largest rate."),
              _why(found["launches"])]
    return Html("".join([*parts, *(figure(*item) for item in pictures(found))]))


def _title(launch: dict) -> str:
    return "The launcher as given" if launch["stretch"] == 1.0 else f"Its thrust {launch['stretch']:g} times as long, with the same impulse"


def _counts(launches: list[dict]) -> Html:
    heads = ("thrust, times as long", "cases", "did not settle", "outside the calibration", "exit (ms)", "impulse after the exit (%)")
    return table(heads, [(f"{item['stretch']:g}", f"{item['cases']['asked']:,}", f"{item['not_settled']:,}", f"{item['outside']:,}",
                          number(item["exit_s"] and 1e3 * item["exit_s"]), percent(item["share_after_exit"], 2)) for item in launches])


def _verdicts(launch: dict) -> Html:
    heads = ("error", "leaves the free line at", "about", "verdict", "knee", "95 %", "the paper", "slope before", "after", "misfit (%)", "plateau in resamples (%)")
    rows = []
    for factor in launch["factors"]:
        for name, bent in factor["growth"].items():
            if bent is None:
                continue
            ends = None if bent["low"] is None else f"{bent['low']:.2f} to {bent['high']:.2f}"
            rows.append((f"{factor['label']} ({factor['unit']})", number(factor["departs_from_free_at"]), _SHORT[name], bent["verdict"], number(bent["knee"]),
                         ends, f"{factor['paper']:g}", number(bent["slope_before"]), number(bent["slope_after"]), percent(bent["misfit"], 2),
                         percent(bent["plateau_share"], 2)))
    return table(heads, rows, dense=True)


def _why(launches: list[dict]) -> Html:
    """What the two launches show together."""
    if len(launches) < 2 or launches[0]["share_after_exit"] is None:
        return Html("")
    held, freed = sorted(launches, key=lambda item: item["share_after_exit"])
    factor, other = held["factors"][0], freed["factors"][0]
    rises = [_late_rise(item) for item in (factor, other)]
    after = freed["share_after_exit"] * (other["free"]["rate_y_deg_s"][-1] - other["free"]["rate_y_deg_s"][_half(other)])
    return Html("".join([
        paragraph("Why there may be a plateau: an error turns the payload by its moment, M = F r, until the clearance stops it; from there a larger moment "
                  "only presses harder. Where the thrust burns out on the rail, the walls then carry the payload on with what rate the last touch left, "
                  "and a larger misalignment adds little. Where the payload leaves while the thrust still acts, no wall stops it any more, and the "
                  "moment after the exit adds rate in proportion to the error, J' r/I with the impulse J' that is left: no plateau can outlive that."),
        paragraph(f"Here: with {percent(held['share_after_exit'], 2)} % of the impulse after the exit the largest rate about y changes by {rises[0]} deg/s over the "
                  f"upper half of misalignments; with {percent(freed['share_after_exit'], 2)} % it changes by {rises[1]} deg/s, of which the free moment after the exit "
                  f"alone gives {number(after)}.")]))


def _half(factor: dict) -> int:
    return len(factor["sizes"]) // 2 - 1


def _late_rise(factor: dict) -> str:
    values = factor["largest"]["rate_y_deg_s"]
    first, last = values[_half(factor)], values[-1]
    return "–" if None in (first, last) else f"{last - first:+.3g}"
