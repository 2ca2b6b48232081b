"""How cost grows on the page: time over elements and over pads with fitted exponents, and what
effects cost."""

import math

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.studies.render.chart import AMBER, NAVY, VERMILION, Chart, Line, Panel
from tipoff.studies.render.markup import Html, caption, paragraph, table

WORDS = (
    "Time of one processor on {condition}: of a whole run of the reference, of the time loop of "
    "the surrogate. Left and "
    "middle: fitted power laws, and dotted the exponent 4/3. Right: over the time without any "
    "effect; "
    "the last marker has every effect on, those before it the same without friction, and without "
    "contact."
)
_LOOKS = {
    FINITE_ELEMENTS: (NAVY, "s", "-"),
    SPRINGS: (AMBER, "o", "--"),
    COMPLIANT: (VERMILION, "D", "-."),
}
_EXPECTED = (
    "Expected over elements: 1 for a step, and 4/3 for a run, whose steps get shorter with the "
    "edges of the elements; "
    "less where much of a step is the same on any mesh, and where the thickness of the walls sets "
    "the step. Another "
    "number of pads is another motion of the same payload: rear bands alone, or more bands between "
    "the outer ones."
)
_PRICES = (
    "Effects differ in what they are, so no power of their number means anything. First lines: "
    "times with effects added to "
    "those above, in brackets over the time without any. Lines below: what each costs alone, "
    "all effects against all but it; below zero where the motion without it is the dearer one. "
    "From the ablation study."
)


def picture(found: dict) -> Chart:
    """Three panels: elements, pads, effects; ``found`` is the scaling of cost_study.json."""
    elements = found["elements"]
    first = elements["points"][0]
    expected = [
        first["time_s"] * (point["n"] / first["n"]) ** (4.0 / 3.0) for point in elements["points"]
    ]
    steep = Line(
        [point["n"] for point in elements["points"]], expected, "exponent 4/3", NAVY, 1.0, ":"
    )
    panels = [
        Panel(
            "elements of the rails", "elements", "time of a run (s)", [*_law(elements), steep], True
        ),
        Panel(
            "pads",
            "pads",
            "time of a run (s)",
            [line for law in found["pads"] for line in _law(law)],
            True,
            ticks=tuple(point["n"] for point in found["pads"][0]["points"]),
        ),
        Panel(
            "effects",
            "effects that are on",
            "time over that without any",
            [_ladder(item) for item in found["effects"]],
        ),
    ]
    return Chart("scaling", panels, columns=3, height=320)


def _law(law: dict) -> list[Line]:
    """The points of one model, and the fitted line, which goes through their geometric means, where
    there is one."""
    colour, marker, dash = _LOOKS[law["model"]]
    sizes, times = ([point[key] for point in law["points"]] for key in ("n", "time_s"))
    points = Line(sizes, times, law["model"], colour, 1.6, "", marker=marker)
    if law["run"]["exponent"] is None:
        return [points]
    size, time = (math.exp(sum(map(math.log, values)) / len(values)) for values in (sizes, times))
    fit = [time * (each / size) ** law["run"]["exponent"] for each in sizes]
    return [points, Line(sizes, fit, law["model"], colour, 1.4, dash, legend=False)]


def _ladder(item: dict) -> Line:
    colour, marker, dash = _LOOKS[item["model"]]
    ratios = [rung["time_s"] / item["none_s"] for rung in item["ladder"]]
    return Line(
        [rung["on"] for rung in item["ladder"]],
        ratios,
        item["model"],
        colour,
        1.4,
        dash,
        marker=marker,
    )


def tables(found: dict) -> Html:
    """Exponents, the points they were fitted to, and the price of each effect."""
    return Html(
        paragraph(
            "How cost grows: t = c n",
            Html("<sup>p</sup>"),
            ", the exponent p with its standard error.",
        )
        + _exponents(found)
        + caption(_EXPECTED + _shares(found["elements"]))
        + _meshes(found["elements"])
        + _pads(found["pads"])
        + _prices(found["effects"])
        + caption(_PRICES)
    )


def exponent(law: dict) -> str:
    """An exponent with its standard error; a dash where sizes do not differ."""
    error = law["standard_error"]
    if law["exponent"] is None:
        return "–"
    return f"{round(law['exponent'], 2) + 0.0:.2f}" + ("" if error is None else f" ± {error:.2f}")


def _exponents(found: dict) -> Html:
    elements = found["elements"]
    finest = elements["finest"] | {"model": elements["model"], "points": elements["points"][-2:]}
    laws = [
        ("elements", elements),
        ("elements, two finest meshes", finest),
        *(("pads", law) for law in found["pads"]),
    ]
    return table(
        ("over", "model", "from", "to", "p of a run", "p of a step"),
        [
            (
                over,
                law["model"],
                f"{law['points'][0]['n']:,}",
                f"{law['points'][-1]['n']:,}",
                exponent(law["run"]),
                exponent(law["step"]),
            )
            for over, law in laws
        ],
    )


def _shares(law: dict) -> str:
    if law["fixed_s"] is None:
        return " The mesh is given, so there is but one."
    return (
        f" Here a step takes {1e6 * law['fixed_s']:.3g} µs on any mesh and "
        f"{1e9 * law['element_s']:.3g} ns for each element."
    )


def _meshes(law: dict) -> Html:
    rows = [
        (
            f"{1e3 * point['element_size_m']:g}",
            f"{point['n']:,}",
            f"{point['steps']:,.0f}",
            f"{point['time_s']:.3g}",
            f"{1e6 * point['step_s']:.3g}",
            point["repeats"],
        )
        for point in law["points"]
    ]
    return table(
        ("element size (mm)", "elements", "steps", "time of a run (s)", "of a step (µs)", "runs"),
        rows,
    )


def _pads(laws: list[dict]) -> Html:
    rows = [
        (
            law["model"],
            *(
                f"{_milliseconds(point['time_s'])}; {1e6 * point['step_s']:.3g}"
                for point in law["points"]
            ),
        )
        for law in laws
    ]
    return table(
        (
            "pads: time of a run (ms); of a step (µs)",
            *(str(point["n"]) for point in laws[0]["points"]),
        ),
        rows,
    )


def _prices(found: list[dict]) -> Html:
    """Rungs of the ladder, then each effect alone; the models side by side."""
    first = found[0]
    rungs = [
        (rung["added"], rung["on"], *(_price(item["ladder"][at]["time_s"], item) for item in found))
        for at, rung in enumerate(first["ladder"])
    ]
    alone = [
        (
            f"{one['effect'].replace('_', ' ')} alone",
            "",
            *(_price(item["effects"][at]["time_s"], item) for item in found),
        )
        for at, one in enumerate(first["effects"])
    ]
    return table(("effects", "on", *(f"{item['model']} (ms)" for item in found)), [*rungs, *alone])


def _price(seconds: float, item: dict) -> str:
    return f"{_milliseconds(seconds)} ({seconds / item['none_s']:.2f})"


def _milliseconds(seconds: float) -> str:
    """Three digits, or all before the point: models differ by three powers of ten."""
    return f"{1e3 * seconds:,.0f}" if abs(seconds) >= 0.1 else f"{1e3 * seconds:.3g}"
