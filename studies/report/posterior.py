"""Posterior on the page: intervals of the constants with the discrepancy and without, profiles, predicted and reference rates."""

import math
from html import escape

import numpy as np

from calibrate.profile import DROP
from studies.agreement import prediction
from studies.agreement.metrics import AXES
from studies.report.chart import AMBER, GREY, NAVY, TEAL, VERMILION, Chart, Line, Panel
from studies.report.markup import Html, caption, fold, number, paragraph, percent, table

WORDS = ("Constants: log likelihood with the discrepancy integrated out, relative to its largest value, all other constants "
         "found again (profile); marginal: logarithm of the share of draws per bin, likewise relative. Bars: 95 % intervals, "
         "triangles where every sample is taken for independent noise about a model that is right. A flat line is a constant the "
         "curves do not tell. Rates: the line is equality; broad bars: what the constants leave open; dotted ones: with the "
         "discrepancy.")
_LOWEST = -8.0  # of the log likelihood, drawn
_BINS = 12
_TITLES = dict(zip(AXES, ("roll rate", "y rate", "z rate")))


def picture(document: dict) -> Chart:
    """A panel for each constant, and one for each axis of the settled rates."""
    constants = [_constant(document, index) for index in range(len(document["parameters"]))]
    return Chart("posterior", constants + [_rates(document, index) for index in range(3)], columns=4, height=270)


def tables(document: dict) -> Html:
    """Intervals with and without discrepancy, what is not told, coverage; the rest folded."""
    rows = [(name, number(best, 4), _interval(ends), _interval(narrow), _interval(linear), unit,
             number(spread, 2)) for name, best, ends, narrow, linear, unit, spread in zip(
                 *(document[key] for key in ("parameters", "best", "intervals", "without")), _linear(document), document["units"],
                 document["spread"])]
    notes = "".join(f"<li>{escape(words)}</li>" for words in document["notes"]) or "<li>nothing: each constant has an interval</li>"
    doubts = "".join(f'<div class="notice">Not converged: {escape(words)}</div>' for words in document["chain"]["doubts"])
    together = [(name, *(f"{value:+.2f}" for value in line)) for name, line in zip(document["parameters"], document["correlation"])]
    return Html("".join([
        doubts, table(("constant", "calibrated", "95 % with the discrepancy", "95 % if every sample were noise",
                       "95 % linear, as calibrated", "unit", "spread, of the prior's"), rows, "posterior-constants"),
        f"<h3>What the curves cannot tell</h3><ul>{notes}</ul>", _covered(document["coverage"]),
        fold("predicted settled rates by condition (deg/s): median, 95 % by the constants alone, 95 % with the discrepancy",
             table(("condition", "role", "axis", "reference", "median", "by the constants", "with the discrepancy", "holds it"),
                   list(_predicted(document["predicted"])), dense=True)),
        fold("the discrepancy, and how the draws were made", _errors(document), _chain(document["chain"])),
        fold("correlations of the constants", table(("", *document["parameters"]), together))]))


def _constant(document: dict, index: int) -> Panel:
    name, unit = document["parameters"][index], document["units"][index]
    profile, samples = document["profile"][name], np.array(document["samples"][name])
    logarithmic = document["logarithmic"][index]  # a prior uniform there is flat in bins that are equal there
    counts, edges = np.histogram(np.log(samples) if logarithmic else samples, bins=_BINS)
    there, middle = counts > 0, 0.5 * (edges[1:] + edges[:-1])
    marginal = np.log(counts[there] / counts.max())
    lines = [Line(profile["value"][::len(profile["value"]) - 1], [-DROP] * 2, "95 % limit of a profile", GREY, 1.0, ":"),
             Line(profile["value"], np.maximum(profile["drop"], _LOWEST), "profile", NAVY, 2.0, marker="o"),
             Line((np.exp(middle) if logarithmic else middle)[there], marginal, "marginal", AMBER, 1.6, "--")]
    bars = ((document["intervals"][index], "95 % with the discrepancy", -DROP, VERMILION, "s"),
            (document["without"][index], "95 % if every sample were noise", -DROP - 0.8, GREY, "^"))
    lines += [Line(ends, [height] * 2, words, colour, 2.4, marker=marker) for ends, words, height, colour, marker in bars if ends]
    return Panel(name, f"{name} ({unit})" if unit != "1" else name, "relative log likelihood", lines)


def _rates(document: dict, axis: int) -> Panel:
    known = [item for item in document["predicted"] if item["touches"] and item["reference_deg_s"] and item["median_deg_s"]]
    reference = [item["reference_deg_s"][axis] for item in known]
    ends = [min(reference, default=0.0), max(reference, default=1.0)]
    lines = [Line(ends, ends, "equality", GREY, 1.2)]
    for role, colour, marker in (("fitted", NAVY, "o"), ("held_out", VERMILION, "s")):
        own = [item for item in known if item["role"] == role]
        for item in own:
            place = [item["reference_deg_s"][axis]] * 2
            lines += [Line(place, item["total_deg_s"][axis], "95 % of a rate", colour, 1.4, ":", legend=False),
                      Line(place, item["parameter_deg_s"][axis], "95 % of a rate by the constants", TEAL, 4.0, legend=False)]
        if own:
            lines.append(Line([item["reference_deg_s"][axis] for item in own], [item["median_deg_s"][axis] for item in own],
                              role.replace("_", " "), colour, dash="", marker=marker))
    return Panel(_TITLES[AXES[axis]], "reference (deg/s)", "predicted (deg/s)", lines)


def _linear(document: dict) -> list:
    """Intervals of calibration.json; what was held there has none."""
    found = [None if None in ends else ends for ends in document["linear"]]
    return found + [None] * (len(document["parameters"]) - len(found))


def _interval(ends: list[float] | None) -> str | Html:
    return "not told" if ends is None else f"{number(ends[0], 4)} to {number(ends[1], 4)}"


def _covered(found: dict) -> Html:
    said = prediction.covered(found)
    return Html(paragraph(f"{said[0].upper()}{said[1:]}.") + caption(
        "The three axes of a condition are not independent of each other, so the band is the narrowest there could be. Fitted "
        "conditions were seen by the constants and by the size of the discrepancy; held-out ones by neither. "
        "Conditions in which no pad touches are not counted, nor those whose reference is not converged."))


def _predicted(rows: list[dict]):
    for item in rows:
        for index, axis in enumerate(AXES):
            reference = item["reference_deg_s"] and f"{item['reference_deg_s'][index]:+.3f}"
            head = (item["condition"] + ("" if item["touches"] else " (no pad touches)"), item["role"].replace("_", " "),
                    axis, reference)
            if item["median_deg_s"] is None:
                yield *head, None, None, None, None
                continue
            yield (*head, f"{item['median_deg_s'][index]:+.3f}", _signed(item["parameter_deg_s"][index]),
                   _signed(item["total_deg_s"][index]), item["total_holds"] and item["total_holds"][index])


def _signed(ends: list[float]) -> str:
    return f"{ends[0]:+.3f} to {ends[1]:+.3f}"


def _errors(document: dict) -> Html:
    rows = [(name.replace("_", " "), percent(item["relative_size"], 2), number(1e3 * item["correlation_time_s"], 3),
             f"{item['independent']:.0f} of {item['samples']}") for name, item in document["errors"].items()]
    return table(("quantity", "size, of its amplitude (%)", "correlation time (ms)", "samples that count"), rows)


def _chain(found: dict) -> Html:
    longest = math.ceil(max(found["autocorrelation_steps"]))
    return paragraph(f"{found['walkers']} walkers of {found['steps']} steps, the first quarter dropped; "
                     f"{percent(found['accepted'], 2)} % of moves accepted; autocorrelation time up to {longest} steps, so "
                     f"{found['effective']:.0f} independent draws; {found['evaluations']:,} evaluations; seed {found['seed']}.")
