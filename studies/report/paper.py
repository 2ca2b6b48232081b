"""The paper's own numbers on the page: its Table 2 and headline beside ours, the inputs that must have been, and what they
trade."""

from typing import Callable

import numpy as np

from studies import published
from studies.report.chart import AMBER, GREY, NAVY, VERMILION, Chart, Line, Panel
from studies.report.markup import Html, fold, number, paragraph, table

_AXES = tuple(zip("xyz", (NAVY, VERMILION, AMBER), ("o", "s", "^")))


def draw(found: dict, figure: Callable[[Chart, str], Html]) -> Html:
    """The section."""
    picture, = charts(found)
    best = found["searches"][found["best"]]
    words = (f"The paper prints no geometry, inertia, thrust, friction or clearance. {len(found['searches'])} searches over "
             f"{len(found['inputs'])} inputs within physical bounds ask which would give the nine rates of its Table 2 and their "
             f"54 deviations, half of them also that no rate of conditions 1 and 5 exceeds {found['negligible_deg_s']:g} deg/s, "
             "where the paper speaks of negligible rates and prints none. The best misses a printed rate by at most "
             f"{best['largest_error_deg_s']:.2g} deg/s and a deviation by {best['largest_deviation_error_deg_s']:.2g} deg/s; its "
             "largest rate on conditions 1 and 5 is "
             f"{best['largest_negligible_deg_s']:.2g} deg/s. It is the catalogue's scene paper_like: inferred, one of many that "
             "would do.")
    return Html(paragraph(words) + figure(picture, _CAPTION) + paragraph(_verdict(found)) + _table2(best) + _inputs(found)
                + fold("Every search", _searches(found)) + _headline(found)
                + paragraph("On the printed numbers: " + " ".join(found["slips"])))


_CAPTION = ("Left: what every search met on its way, largest error of the nine printed rates against the largest rate of "
            "conditions 1 and 5; filled markers are where searches ended. Middle and right: printed rates and their deviations "
            "against those of the best set; on the line they agree.")


def charts(found: dict) -> list[Chart]:
    """Trade-off of all searches, and printed against found rates and deviations of the best."""
    front = np.array(found["front"])
    ends = {stress: [(item["largest_error_deg_s"], item["largest_negligible_deg_s"]) for item in found["searches"]
                     if item["stress"] == stress]
            for stress in sorted({item["stress"] for item in found["searches"]})}
    looks = ((GREY, "s"), (NAVY, "o"))
    trade = [Line(front[:, 0], front[:, 1], "best of all met", VERMILION)]
    trade += [Line(*zip(*pairs), "ended, three conditions asked" if stress == 0.0 else "ended, all five asked", colour, dash="",
                   marker=marker) for (stress, pairs), (colour, marker) in zip(ends.items(), looks)]
    best, printed = found["searches"][found["best"]], published.sensitivity()
    rates = np.array(best["rates_deg_s"])[1:4]
    deviations = np.array(best["changed_deg_s"]) - rates[:, None, :]
    return [Chart("paper", [
        Panel("What cannot be had at once", "largest error of nine rates, deg/s", "largest rate, conditions 1 and 5, deg/s",
              trade, log=True),
        _against("Nine rates, deg/s", printed.baseline, rates),
        _against("54 deviations, deg/s", printed.deviations(), deviations)], columns=3)]


def _against(title: str, printed: np.ndarray, ours: np.ndarray) -> Panel:
    """Panel of ``ours`` over ``printed`` (..., 3)."""
    ends = [float(min(printed.min(), ours.min())), float(max(printed.max(), ours.max()))]
    points = [Line(printed[..., axis].ravel(), ours[..., axis].ravel(), f"about {name}", colour, dash="", marker=marker)
              for axis, (name, colour, marker) in enumerate(_AXES)]
    return Panel(title, "printed", "found", [Line(ends, ends, "equal", GREY, dash="--"), *points])


def _table2(best: dict) -> Html:
    printed, changed = published.sensitivity(), np.array(best["changed_deg_s"])
    nominal = np.array(best["rates_deg_s"])[1:4]
    units = {"k": "N/mm^e", "c": "N s/mm", "d": "mm"}
    rows = []
    for place, condition in enumerate(published.SENSITIVE):
        rows.append((str(condition), "baseline", *_pairs(printed.baseline[place], nominal[place])))
        rows += [(str(condition), f"{name} = {value:g} {units[name]}", *_pairs(printed.changed[place, row], changed[place, row]))
                 for row, (name, value) in enumerate(published.CHANGES)]
    return fold("Table 2, printed and found", table(("condition", "constant", *(f"{axis}, {kind} (deg/s)" for axis in "xyz"
                                                                               for kind in ("printed", "found"))),
                                                    rows, dense=True))


def _pairs(printed: np.ndarray, ours: np.ndarray) -> list[str]:
    return [f"{value:+.3f}" for pair in zip(printed, ours) for value in pair]


def _verdict(found: dict) -> str:
    limit = found["admissible_deg_s"]
    ends = [item for item in found["searches"] if max(item["largest_error_deg_s"], item["largest_deviation_error_deg_s"]) <= limit]
    quiet = [item for item in ends if item["largest_negligible_deg_s"] <= found["negligible_deg_s"]]
    if quiet:
        return (f"{len(quiet)} searches met all within {limit:g} deg/s: printed rates, their deviations and negligible ones can "
                "hold together.")
    least = min((size for error, size in found["front"] if error <= limit), default=None)
    if least is None:
        return (f"No search met all nine rates within {limit:g} deg/s; the figure shows how close they came, and at which rates of "
                "conditions 1 and 5.")
    return (f"{len(ends)} searches ended within {limit:g} deg/s of all nine rates and 54 deviations, none of them with negligible "
            f"rates on conditions 1 and 5. Where nine rates are met as closely, whatever the deviations, the least largest rate "
            f"met there is {least:.2g} deg/s.")


def _headline(found: dict) -> Html:
    """Cost of one case in both fidelities, the paper's beside ours."""
    printed, ours = found["headline"], found["ours"]
    rows = [("the paper", "LS-DYNA, 4 million hexahedra", f"{printed['high_fidelity_wall_time']} h",
             f"ADAMS, {printed['low_fidelity_wall_time']} s", f"{float(printed['speedup']):,.0f}")]
    if ours:
        rows.append(("here, its own reference scene", "explicit finite elements", f"{ours['highfi_wall_s']:.3g} s",
                     f"calibrated surrogate, {1e3 * ours['lowfi_wall_s']:.3g} ms", f"{ours['ratio']:,.0f}"))
    return table(("", "flexible rail", "one case", "rigid bodies, one case", "times as fast"), rows)


def _inputs(found: dict) -> Html:
    rows = [(item["name"].replace("_", " "), item["unit"], number(item["low"]), number(item["high"]), number(item["best"], 4),
             number(item["from"]), number(item["to"]), item["share"] and f"{100.0 * item['share']:.0f} %", item["reason"])
            for item in found["inputs"]]
    heads = ("input", "unit", "bound from", "to", "best", "admissible from", "to", "of the bounds", "why these bounds")
    return table(heads, rows, dense=True) + paragraph(
        f"Admissible is what misses no printed rate and no deviation by more than {found['admissible_deg_s']:g} deg/s.")


def _searches(found: dict) -> Html:
    rows = [(f"{item['seed'] + 1}", "five" if item["stress"] else "three", number(item["largest_error_deg_s"]),
             number(item["largest_negligible_deg_s"]), number(item["largest_deviation_error_deg_s"]), number(item["misfit"]),
             str(item["admissible"]))
            for item in found["searches"]]
    return table(("search", "conditions asked", "largest error of nine rates (deg/s)", "largest rate, conditions 1 and 5 (deg/s)",
                  "largest error of 54 deviations (deg/s)", "misfit", "admissible points kept"), rows)
