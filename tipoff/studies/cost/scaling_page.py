"""Growth of the run time on the page: time over elements and over pads with fitted exponents, and
the time of effects."""

import math

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Part
from tipoff.studies.render.palette import AMBER, NAVY, VERMILION
from tipoff.studies.render.table import Cells, Column, Noted, Table, number

CAPTION = (
    "Processor time on {condition}: of a whole run of the reference, of the time loop of the "
    "surrogate. Left and middle: fitted power laws, dotted the exponent 4/3. Right: time relative "
    "to that without effects; the last point has all effects, those before lack friction, then "
    "contact."
)
_LOOKS = {
    FINITE_ELEMENTS: (NAVY, "s", "-"),
    SPRINGS: (AMBER, "o", "--"),
    COMPLIANT: (VERMILION, "D", "-."),
}
_EXPECTED = (
    "Time t = c n^p, p with its standard error. Expected over elements: 1 for a step, 4/3 for a "
    "run. Values are smaller if part of a step takes the same time on any mesh, or if the "
    "thickness of the walls limits the time step. Other numbers of pads also change the motion."
)
_TIMES = (
    "In brackets: time relative to that without effects. First rows: nested sets of effects. "
    "Rows below, from the ablation study: time with all effects minus time without this effect. "
    "It is negative if the motion without the effect takes longer."
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
            "active effects",
            "time relative to no effects",
            [_ladder(item) for item in found["effects"]],
        ),
    ]
    return Chart("scaling", panels, columns=3, height=320)


def _law(law: dict) -> list[Line]:
    """The points of one model, and the fitted line through their geometric means, if it exists."""
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
    ratios = [step["time_s"] / item["none_s"] for step in item["ladder"]]
    return Line(
        [step["on"] for step in item["ladder"]],
        ratios,
        item["model"],
        colour,
        1.4,
        dash,
        marker=marker,
    )


def tables(found: dict) -> list[Part]:
    """Exponents, the points they are fitted to, and the time of each effect."""
    elements = found["elements"]
    return [_exponents(found), _meshes(elements), _pads(found["pads"]), _times(found["effects"])]


def exponent(law: dict) -> str:
    """An exponent with its standard error; a dash where sizes do not differ."""
    error = law["standard_error"]
    if law["exponent"] is None:
        return "–"
    return f"{round(law['exponent'], 2) + 0.0:.2f}" + ("" if error is None else f" ± {error:.2f}")


def _exponents(found: dict) -> Table:
    elements = found["elements"]
    finest = elements["finest"] | {"model": elements["model"], "points": elements["points"][-2:]}
    laws = [
        ("elements", elements),
        ("elements, two finest meshes", finest),
        *(("pads", law) for law in found["pads"]),
    ]
    rows = [
        (
            over,
            law["model"],
            law["points"][0]["n"],
            law["points"][-1]["n"],
            exponent(law["run"]),
            exponent(law["step"]),
        )
        for over, law in laws
    ]
    heads = ("over", "model", "from", "to", "p of a run", "p of a step")
    return Table(heads, rows, (_EXPECTED, _step(elements)))


def _step(law: dict) -> str:
    if law["fixed_s"] is None:
        return "The mesh is from a file, so there is only one."
    return (
        f"A step takes {1e6 * law['fixed_s']:.3g} µs on any mesh and "
        f"{1e9 * law['element_s']:.3g} ns for each element."
    )


def _meshes(law: dict) -> Table:
    columns: Cells = (
        (Column("element size", "mm", "g", 1e3), "element_size_m"),
        ("elements", "n"),
        (Column("steps", form=",.0f"), "steps"),
        (Column("time of a run", "s"), "time_s"),
        (Column("time of a step", "µs", scale=1e6), "step_s"),
        ("runs", "repeats"),
    )
    return Table.of(law["points"], columns)


def _pads(laws: list[dict]) -> Table:
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
    counts = [f"pads: {point['n']}" for point in laws[0]["points"]]
    return Table(["time of a run (ms); of a step (µs)", *counts], rows)


def _times(found: list[dict]) -> Table:
    """Times of the sets of effects, then of each effect, by model."""
    first = found[0]
    sets = [
        (item["added"], item["on"], *(_time(model["ladder"][at], model) for model in found))
        for at, item in enumerate(first["ladder"])
    ]
    alone = [
        (
            f"{item['effect'].replace('_', ' ')} alone",
            "",
            *(_time(model["effects"][at], model) for model in found),
        )
        for at, item in enumerate(first["effects"])
    ]
    models = [f"{item['model']} (ms)" for item in found]
    return Table(["effects", "number", *models], [*sets, *alone], (_TIMES,))


def _time(item: dict, model: dict) -> Noted:
    return Noted(_milliseconds(item["time_s"]), number(item["time_s"] / model["none_s"], ".2f"))


def _milliseconds(seconds: float) -> str:
    """Three digits, or all before the point, because times span three powers of ten."""
    return f"{1e3 * seconds:,.0f}" if abs(seconds) >= 0.1 else f"{1e3 * seconds:.3g}"
