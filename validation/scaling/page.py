"""Growth of the run time on the page: time over elements and over pads with fitted exponents, and
the time of effects."""

import math
from collections.abc import Sequence

from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Part
from tipoff.studies.render.palette import AMBER, NAVY, VERMILION
from tipoff.studies.render.table import Noted, Table, number
from validation.scaling.results import (
    EffectTime,
    EffectTimes,
    Growth,
    Laws,
    MeshGrowth,
    PowerLaw,
    Rung,
    Scaling,
    Timing,
    Trend,
)

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
_TRENDS = (
    "Processor time over length and cases, wall time over threads; the shorter of two calls. Longer "
    "rails have the mounts of several rails end to end. The magnitude of p is smaller if a part of "
    "the task does not depend on the size, or if threads share one processor."
)
_TIMES = (
    "In brackets: time relative to that without effects. First rows: nested sets of effects. "
    "Rows below, from the ablation study: time with all effects minus time without this effect. "
    "It is negative if the motion without the effect takes longer."
)


def draw(found: Scaling) -> list[Part]:
    """The picture and the tables."""
    return [
        Figure(lambda: picture(found), CAPTION.format(condition=found.condition)),
        *tables(found),
    ]


def picture(found: Scaling) -> Chart:
    """Three panels: elements, pads, effects."""
    elements = found.elements
    first = elements.points[0]
    expected = [first.time_s * (point.n / first.n) ** (4.0 / 3.0) for point in elements.points]
    steep = Line(
        [point.n for point in elements.points],
        expected,
        name="exponent 4/3",
        colour=NAVY,
        width=1.0,
        dash=":",
    )
    panels = [
        Panel(
            "elements of the rails",
            "elements",
            y_label="time of a run (s)",
            lines=[*_law(elements), steep],
            log=True,
        ),
        Panel(
            "pads",
            "pads",
            y_label="time of a run (s)",
            lines=[line for law in found.pads for line in _law(law)],
            log=True,
            ticks=tuple(point.n for point in found.pads[0].points),
        ),
        Panel(
            "effects",
            "active effects",
            y_label="time relative to no effects",
            lines=[_ladder(item) for item in found.effects],
        ),
    ]
    return Chart("scaling", panels, columns=3, height=320)


def _law(law: Growth) -> list[Line]:
    """The points of one model, and the fitted line through their geometric means, if it exists."""
    colour, marker, dash = _LOOKS[law.model]
    sizes, times = zip(*((point.n, point.time_s) for point in law.points))
    points = Line(sizes, times, name=law.model, colour=colour, width=1.6, dash="", marker=marker)
    if law.run.exponent is None:
        return [points]
    size, time = (math.exp(sum(map(math.log, values)) / len(values)) for values in (sizes, times))
    fit = [time * (each / size) ** law.run.exponent for each in sizes]
    return [
        points,
        Line(sizes, fit, name=law.model, colour=colour, width=1.4, dash=dash, legend=False),
    ]


def _ladder(item: EffectTimes) -> Line:
    colour, marker, dash = _LOOKS[item.model]
    ratios = [step.time_s / item.none_s for step in item.ladder]
    return Line(
        [step.on for step in item.ladder],
        ratios,
        name=item.model,
        colour=colour,
        width=1.4,
        dash=dash,
        marker=marker,
    )


def tables(found: Scaling) -> list[Part]:
    """Exponents, the points they are fitted to, and the time of each effect."""
    elements = found.elements
    return [
        _exponents(found),
        _meshes(elements),
        _pads(found.pads),
        _trends(found.trends),
        _times(found.effects),
    ]


def exponent(law: PowerLaw) -> str:
    """An exponent with its standard error; a dash for a single size."""
    error = law.standard_error
    if law.exponent is None:
        return "–"
    return f"{round(law.exponent, 2) + 0.0:.2f}" + ("" if error is None else f" ± {error:.2f}")


def _exponents(found: Scaling) -> Table:
    elements = found.elements
    finest = elements.finest
    laws: list[tuple[str, Growth, Sequence[Timing], Growth | Laws]] = [
        ("elements", elements, elements.points, elements),
        ("elements, two finest meshes", elements, elements.points[-2:], finest),
        *(("pads", law, law.points, law) for law in found.pads),
    ]
    rows = [
        (over, of.model, points[0].n, points[-1].n, exponent(law.run), exponent(law.step))
        for over, of, points, law in laws
    ]
    heads = ("over", "model", "from", "to", "p of a run", "p of a step")
    return Table(heads, rows, notes=(_EXPECTED, _step(elements)))


def _step(law: MeshGrowth) -> str:
    if law.fixed_s is None or law.element_s is None:
        return "The mesh is from a file, so there is only one."
    return (
        f"A step takes {1e6 * law.fixed_s:.3g} µs on any mesh and "
        f"{1e9 * law.element_s:.3g} ns for each element."
    )


def _meshes(law: MeshGrowth) -> Table:
    names = ("element_size_m", "n", "steps", "time_s", "step_s", "repeats")
    return Table.of_records(law.points, *names)


def _pads(laws: Sequence[Growth]) -> Table:
    rows = [
        (
            law.model,
            *(f"{_milliseconds(point.time_s)}; {1e6 * point.step_s:.3g}" for point in law.points),
        )
        for law in laws
    ]
    counts = [f"pads: {point.n}" for point in laws[0].points]
    return Table(["time of a run (ms); of a step (µs)", *counts], rows)


def _trends(trends: Sequence[Trend]) -> Table:
    rows = [
        (
            trend.task,
            trend.size,
            ", ".join(f"{size:,.4g}" for size in trend.sizes),
            ", ".join(f"{seconds:.2g}" for seconds in trend.times_s),
            exponent(trend.law),
            f"{trend.expected:g}",
        )
        for trend in trends
    ]
    return Table(["task", "over", "sizes", "times (s)", "p", "expected"], rows, notes=(_TRENDS,))


def _times(found: Sequence[EffectTimes]) -> Table:
    """Times of the sets of effects, then of each effect, by model."""
    first = found[0]
    sets = [
        (item.added, item.on, *(_time(model.ladder[at], model) for model in found))
        for at, item in enumerate(first.ladder)
    ]
    alone = [
        (
            f"{item.effect.replace('_', ' ')} alone",
            "",
            *(_time(model.effects[at], model) for model in found),
        )
        for at, item in enumerate(first.effects)
    ]
    models = [f"{item.model} (ms)" for item in found]
    return Table(["effects", "number", *models], [*sets, *alone], notes=(_TIMES,))


def _time(item: Rung | EffectTime, model: EffectTimes) -> Noted:
    return Noted(_milliseconds(item.time_s), number(item.time_s / model.none_s, ".2f"))


def _milliseconds(seconds: float) -> str:
    """Three digits, or all digits before the point, because times span three powers of ten."""
    return f"{1e3 * seconds:,.0f}" if abs(seconds) >= 0.1 else f"{1e3 * seconds:.3g}"
