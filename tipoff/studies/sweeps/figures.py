"""Figures of the sweeps: rates over size and direction, growth of the largest rates, and polar maps."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from tipoff.studies.render.chart import Chart, Line, Panel, Picture, marks
from tipoff.studies.render.document import Figure
from tipoff.studies.render.palette import AMBER, AXIS_COLOURS, GREY, NAVY, TEAL
from tipoff.studies.sweeps.results import Launch, Sides, Sweeps, Swept

_LOOKS = {
    "rate_x_deg_s": ("x", "o", "-."),
    "rate_y_deg_s": ("y", "s", "-"),
    "rate_z_deg_s": ("z", "^", "--"),
}
_APART = 0.018  # shift as a share of the axis, so that points of three axes do not hide each other
_WALLS = {"-y": NAVY, "+y": TEAL, "-z": AMBER, "+z": "#dfe3e8"}  # dark to light
_ANGLE = {
    "misalignment": "phi, from +y towards +z",
    "thrust_eccentricity": "alpha, from +z towards +y",
    "mass_eccentricity": "beta, from +z towards +y",
}
_GROWTH = (
    "Largest rate over all directions against the size of the error; top: as given, below: with "
    "the stretched thrust. Grey: a free payload, w = I^-1 J (r x f). Shaded: the 95 % interval of "
    "a knee before a plateau about y or z."
)
_SCATTER = (
    "Settled rates of all cases against the size (left) and the direction {angle} (right). Points "
    "of the three axes are shifted to be visible."
)
_MAP = (
    "Settled rates over size (radius, {unit}) and direction ({angle}); the line is a rate of zero. "
    "Below: the wall touched first and the wall with the largest impulse, from single runs on a "
    "coarser grid of directions. {jumps}"
)


def figures(found: Sweeps) -> list[Figure]:
    """Every figure of the study and its caption."""
    given = found.launches[0]
    drawn = [Figure(lambda: _growth(found), _GROWTH)]
    for factor in given.factors:
        angle = _ANGLE[factor.name]
        drawn.append(Figure(partial(_scatter, factor), _SCATTER.format(angle=angle)))
        if sides := factor.sides:
            caption = _MAP.format(unit=factor.unit, angle=angle, jumps=_jumps(sides.jumps_deg_s))
            drawn.append(Figure(partial(_map, factor, sides, given.faces), caption))
    return drawn


def _jumps(jumps: tuple[float | None, float | None]) -> str:
    """The change of the rates between neighbours with another most loaded face, and between others."""
    if None in jumps:
        return (
            "The most loaded face never changes."
            if jumps[0] is None
            else "The most loaded face changes everywhere."
        )
    return (
        f"Between neighbours of that grid the rates change by {jumps[0]:.2g} deg/s (median) where "
        f"the most loaded face changes, and by {jumps[1]:.2g} deg/s elsewhere."
    )


def _scatter(factor: Swept) -> Chart:
    sizes, angles = np.array(factor.sizes), np.array(factor.angles_deg)
    size, angle = np.meshgrid(sizes, angles, indexing="ij")
    over_size: list[Line] = []
    over_angle: list[Line] = []
    for place, (name, (axis, marker, _)) in enumerate(_LOOKS.items()):
        rates = np.array(factor.values[name], dtype=float).ravel()
        settled = np.isfinite(rates)
        for lines, x, step in (
            (over_size, size, sizes[-1]),
            (over_angle, angle, 180.0 / len(angles)),
        ):
            shifted = x.ravel()[settled] + (place - 1) * _APART * step
            point = shifted, rates[settled], f"rate about {axis}", AXIS_COLOURS[axis], marker
            lines.append(marks(*point, opacity=0.65, size=3.5))
    direction = f"direction {_ANGLE[factor.name].split(',')[0]} (deg)"
    panels = [
        Panel("", label, "rate (deg/s)", lines)
        for label, lines in ((factor.title, over_size), (direction, over_angle))
    ]
    return Chart(f"sweep-{factor.name}", panels, columns=2, height=330)


def _growth(found: Sweeps) -> Chart:
    panels = [_grown(launch, factor) for launch in found.launches for factor in launch.factors]
    columns = len(found.launches[0].factors)
    return Chart("sweep-growth", panels, columns=columns, height=290)


def _grown(launch: Launch, factor: Swept) -> Panel:
    sizes, lines, spans, top = factor.sizes, [], [], 0.0
    for name, (axis, marker, dash) in _LOOKS.items():
        values = [np.nan if value is None else value for value in factor.largest[name]]
        top = max(top, np.nanmax(values, initial=0.0))
        look = AXIS_COLOURS[axis], 1.4, dash
        lines.append(Line(sizes, values, f"about {axis}", *look, marker=marker, size=6.0))
        bent = factor.growth[name]
        if axis == "x" or bent is None or bent.verdict != "plateau":
            continue
        if bent.low is not None and bent.high is not None:
            spans.append((bent.low, bent.high))
    for name, (axis, _, dash) in _LOOKS.items():
        free = np.array(factor.free[name])
        # a free payload may rotate much faster, which would flatten the other lines
        shown = free <= 1.15 * top
        place, named = (np.array(sizes)[shown], free[shown]), axis == "y"
        lines.append(Line(*place, "free payload", GREY, 0.9, dash, legend=named))
    how = "as given" if launch.stretch == 1.0 else f"thrust x {launch.stretch:g} as long"
    title, size = f"{factor.label}, {how}", f"size ({factor.unit})"
    return Panel(title, size, y_label="largest rate (deg/s)", lines=lines, spans=tuple(spans))


def _map(factor: Swept, sides: Sides, faces: Sequence[str]) -> Picture:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure = Figure(figsize=(9.8, 7.2), dpi=130, layout="constrained")
    axes = figure.subplots(2, 3, subplot_kw={"projection": "polar"})
    for place, name in zip(axes[0], _LOOKS):
        _rate_map(figure, place, factor, name)
    for place, walls, title in (
        (axes[1, 0], sides.first, "wall touched first"),
        (axes[1, 1], sides.most, "wall with the largest impulse"),
    ):
        _side_map(place, factor, np.array(walls), np.array(sides.angles_deg), faces)
        place.set_title(title, fontsize=10.5)
    for place in axes.flat[:5]:
        place.tick_params(labelsize=7.5)
        place.set_rticks([0.5 * factor.sizes[-1], factor.sizes[-1]])
        place.grid(linewidth=0.3)
    axes[1, 2].set_axis_off()
    handles: list[Artist] = [
        Patch(facecolor=colour, edgecolor=GREY, label=f"wall at {wall}")
        for wall, colour in _WALLS.items()
    ]
    handles += [
        Line2D(
            [],
            [],
            linestyle="",
            marker="o",
            color="black",
            markerfacecolor="white",
            markersize=4,
            label="front pads (others: rear)",
        ),
        Patch(facecolor="white", edgecolor=GREY, hatch="///", label="no contact"),
    ]
    axes[1, 2].legend(handles=handles, loc="center", frameon=False, fontsize=9)
    figure.suptitle(
        f"{factor.label}: radius 0 to {factor.sizes[-1]:g} {factor.unit}, direction "
        f"{_ANGLE[factor.name]}",
        fontsize=10.5,
    )
    return Picture(f"map-{factor.name}", figure)


def _edges(factor: Swept, angles_deg: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Borders of the cells: angles (rad) and sizes."""
    step = 360.0 / len(angles_deg)
    sizes = np.array(factor.sizes)
    half = 0.5 * (sizes[1] - sizes[0])
    return np.radians(np.append(angles_deg, 360.0) - 0.5 * step), np.append(
        sizes - half, sizes[-1] + half
    )


def _rate_map(figure, axes, factor: Swept, name: str) -> None:
    angles, rates = np.array(factor.angles_deg), np.array(factor.values[name], dtype=float)
    bound = np.nanmax(abs(rates))
    image = axes.pcolormesh(
        *_edges(factor, angles), rates, cmap="cividis", vmin=-bound, vmax=bound, rasterized=True
    )
    around = np.radians(np.append(angles, 360.0))
    axes.contour(
        around,
        factor.sizes,
        np.column_stack([rates, rates[:, 0]]),
        levels=[0.0],
        colors="black",
        linewidths=0.8,
    )
    axes.set_title(f"rate about {_LOOKS[name][0]}", fontsize=10.5)
    figure.colorbar(
        image, ax=axes, orientation="horizontal", shrink=0.75, pad=0.09, label="deg/s"
    ).ax.tick_params(labelsize=7.5)


def _side_map(
    axes, factor: Swept, faces: np.ndarray, angles_deg: np.ndarray, names: Sequence[str]
) -> None:
    from matplotlib.colors import ListedColormap

    walls = list(_WALLS)
    # the last is for no contact, -1
    code = np.array([walls.index(name.split()[1]) for name in names] + [len(walls)])[faces]
    colours = ListedColormap([*_WALLS.values(), "white"])
    axes.pcolormesh(
        *_edges(factor, angles_deg), code, cmap=colours, vmin=-0.5, vmax=len(walls) + 0.5
    )
    place, size = np.meshgrid(np.radians(angles_deg), factor.sizes)
    front = np.array([name.startswith("front") for name in names] + [False])[faces]
    axes.plot(
        place[front],
        size[front],
        "o",
        color="black",
        markerfacecolor="white",
        markersize=3,
        markeredgewidth=0.6,
    )
    free = faces < 0
    axes.plot(
        place[free],
        size[free],
        marker="$/$",
        linestyle="",
        color=GREY,
        markersize=4,
        markeredgewidth=0.3,
    )
