"""A drawing of the rail mesh: all rails, and a cross-section of one; named surfaces are coloured.

It has no background. Text, axes and surfaces have the colours of a light or of a dark page.
"""

from pathlib import Path

import numpy as np

from tipoff.files import replacing
from tipoff.studies.render.palette import AMBER, DARK, GREY, INK, NAVY, TEAL, VERMILION

# taken in turn by surfaces that pads touch
_WALLS = (VERMILION, AMBER, NAVY, "#7b4b94", "#8c6d46", "#5f9ed1", "#c98bb9")
_METAL = "#c6cbd1"
_LIGHT = np.array([0.35, 0.5, 0.8])


def draw_mesh(mesh, path: Path, dark: bool = False) -> None:
    """Write a PNG of ``mesh`` (a ``highfi.mesh.rail_mesh.RailMesh``) for a light or a ``dark``
    page."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    figure = Figure(figsize=(9.6, 4.2), dpi=140, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2, width_ratios=[1.9, 1.0])
    ink = DARK[INK] if dark else INK
    colours = {name: DARK[colour] if dark else colour for name, colour in colours_of(mesh).items()}
    _oblique(left, mesh, colours, ink)
    _section(right, mesh, colours, ink)
    figure.legend(
        [
            Patch(facecolor=_METAL, edgecolor=GREY),
            *(Patch(color=colour) for colour in colours.values()),
        ],
        ["rail", *(name.replace("_", " ") for name in colours)],
        loc="outside lower center",
        ncols=4,
        frameon=False,
        labelcolor=ink,
    )
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", transparent=True)


def colours_of(mesh) -> dict[str, str]:
    """Colour of each named surface, walls first."""
    compliance = sorted(name for name in mesh.surfaces if name != "mount")
    return {name: _WALLS[place % len(_WALLS)] for place, name in enumerate(compliance)} | {
        "mount": TEAL
    }


def _boundary(mesh) -> tuple[np.ndarray, list[str]]:
    """Outer facets (m,4) of the mesh and the name of the surface of each, ``rail`` without one."""
    from tipoff.highfi.mesh.rail_mesh import boundary_facets

    facets = boundary_facets(mesh.cells)
    names = {
        tuple(sorted(facet)): name
        for name, group in mesh.surfaces.items()
        for facet in group.tolist()
    }
    return facets, [names.get(tuple(sorted(facet)), "rail") for facet in facets.tolist()]


def _oblique(axes, mesh, colours: dict[str, str], ink: str) -> None:
    """Draw the facets that face the viewer, from back to front."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    from tipoff.highfi.mesh.facets import normals

    facets, names = _boundary(mesh)
    turn = _view(azimuth=-60.0, elevation=26.0)
    nodes = (mesh.points @ turn.T)[facets]
    normal = normals(nodes)
    corners = nodes[:, :4] if nodes.shape[1] == 4 else nodes[:, :3]
    front = np.flatnonzero(normal[:, 2] > 1e-9)
    order = front[np.argsort(corners[front, :, 2].mean(axis=1))]
    shade = 0.62 + 0.38 * np.abs(normal @ (_LIGHT / np.linalg.norm(_LIGHT)))
    base = np.array([to_rgb(colours.get(name, _METAL)) for name in names])
    axes.add_collection(
        PolyCollection(
            1e3 * corners[order][:, :, :2],
            facecolors=(base * shade[:, None])[order],
            edgecolors="#3b4149",
            linewidths=0.18,
        )
    )
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(f"all rails, {len(mesh.cells):,} elements", fontsize=10.5, color=ink)


def _section(axes, mesh, colours: dict[str, str], ink: str) -> None:
    """Draw the section of one rail, with thick lines for the named surfaces."""
    from matplotlib.collections import LineCollection, PolyCollection

    elements, surfaces = section(mesh)
    axes.add_collection(
        PolyCollection(elements, facecolors="#dfe3e7", edgecolors="#3b4149", linewidths=0.7)
    )
    for name, lines in surfaces.items():
        axes.add_collection(LineCollection(lines, colors=colours[name], linewidths=3.0))
    axes.autoscale()
    axes.margins(0.08)
    axes.set_aspect("equal")
    axes.set_xlabel("y (mm)", fontsize=9, color=ink)
    axes.set_ylabel("z (mm)", fontsize=9, color=ink)
    axes.tick_params(labelsize=8, colors=ink)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["bottom", "left"]].set_color(ink)
    axes.set_title("section of one rail", fontsize=10.5, color=ink)


def section(mesh) -> tuple[list[np.ndarray], dict[str, list[np.ndarray]]]:
    """Polygons (k,2) in mm of the elements that a plane across X cuts in the middle of the rail
    farthest along +y +z, and lines (2,2) of its surfaces by name."""
    from tipoff.highfi.mesh.cells import kind
    from tipoff.highfi.mesh.pieces import pieces

    rail = max(pieces(mesh), key=lambda piece: piece.points[:, 1:].sum(axis=1).mean())
    elements = rail.points[rail.cells]
    centres = elements[:, :, 0].mean(axis=1)
    x = centres[np.argmin(np.abs(centres - centres.mean()))]
    lines = {}
    for name, facets in rail.surfaces.items():
        corners = 4 if facets.shape[1] == 4 else 3  # not the middles of the edges
        around = np.array([(one, (one + 1) % corners) for one in range(corners)])
        lines[name] = _cuts(rail.points[facets], around, x)
    return [_by_angle(points) for points in _cuts(elements, kind(mesh.cells).edges, x)], lines


def _cuts(shapes: np.ndarray, edges: np.ndarray, x: float) -> list[np.ndarray]:
    """Points (k,2), y and z in mm, in which the plane at ``x`` (m) cuts the ``edges`` (e,2) of each of the
    ``shapes`` (n,nodes,3) m that it passes through."""
    along = shapes[:, :, 0] - x
    passed = (along.min(axis=1) < 0.0) & (along.max(axis=1) > 0.0)
    found = []
    for points, height in zip(shapes[passed], along[passed]):
        (first, second), (begin, end) = edges.T, height[edges].T
        crossing = (begin < 0.0) != (end < 0.0)
        share = (begin / np.where(crossing, begin - end, 1.0))[crossing, None]
        one, two = points[first[crossing], 1:], points[second[crossing], 1:]
        found.append(1e3 * (one + share * (two - one)))
    return found


def _by_angle(points: np.ndarray) -> np.ndarray:
    """Corners (k,2) of a convex polygon in their order around it."""
    y, z = (points - points.mean(axis=0)).T
    return points[np.argsort(np.arctan2(z, y))]


def _view(azimuth: float, elevation: float) -> np.ndarray:
    """Rotation (3,3) to eye axes: right, up, towards the eye."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.stack([right, np.cross(towards, right), towards])
