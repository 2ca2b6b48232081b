"""Pictures of a series of frames, drawn off-screen with pyvista: a still at the peak stress, and an
animation of the ejection. Each is drawn for a light page and for a dark one.

Runs as a separate process (``python -m tipoff.studies.view.pictures``, with an order as JSON on standard
input), because a graphics library that cannot draw may end its process. The rails are drawn with their
deformation times a factor, payload and pads to scale.
"""

import json
import os
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tipoff.files import replacing
from tipoff.highfi.mesh.rail_mesh import boundary_facets
from tipoff.studies.view.vtk_files import DISPLACEMENT, PAD, VON_MISES

LARGEST = 1_500_000  # largest animation in bytes; a report contains two
_STILL_SIZE, _SIZE = (1500, 620), (840, 430)
_MOST = 120  # frames of an animation
_SECONDS = 6.0  # duration
_VIEW = (0.52, -0.80, 0.45)  # direction towards the camera, in platform axes
# of the closer view: distance along the rail, and half the visible height (m)
_ALONG, _REACH = 0.9, 0.030
# The lightness falls, so colours are clear in grey too; a rail without stress looks like bare
# metal.
_COLOURS = ("#e4e8ec", "#f6d78b", "#ee9b46", "#d1495b", "#7d2050", "#2c0d33")
_NODE = "node"
_LIFT = -8.0  # towards the camera, in steps of the depth buffer


class Look(NamedTuple):
    """Colours of a picture, and the ending of the names of its files."""

    suffix: str
    paper: str
    ink: str  # text
    body: str  # payload
    pads: str
    edge: str  # of elements
    mark: str  # of the worst node


LIGHT = Look(
    "", "#ffffff", ink="#24292f", body="#8a96a3", pads="#39434e", edge="#5b6570", mark="#1b6ca8"
)
DARK = Look(
    "-dark",
    "#13181e",
    ink="#e6e8eb",
    body="#8a96a3",
    pads="#78848f",
    edge="#5b6570",
    mark="#6db3ea",
)


class Drawing:
    """One plotter for all frames. ``order`` is the request of ``studies.view.stage``."""

    def __init__(
        self,
        order: dict,
        size: tuple[int, int],
        shape: tuple[int, int] = (1, 1),
        look: Look = LIGHT,
    ):
        import pyvista

        self.order, self.folder, self.look = order, Path(order["folder"]), look
        self.plotter = pyvista.Plotter(off_screen=True, window_size=size, shape=shape, border=False)
        self.plotter.set_background(look.paper)
        grid = pyvista.read(self.folder / order["frames"][0]["rails"])
        # VTK splits the facets of quadratic elements and then keeps wrong point ids, so the ids are
        # a field of their own.
        grid[_NODE] = np.arange(grid.n_points, dtype=float)
        self.surface = grid.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1)
        self._node = np.rint(self.surface[_NODE]).astype(int)
        self._grid, self._rest = grid.points.copy(), grid.points[self._node]
        self.net = pyvista.PolyData(
            grid.points.copy(), lines=_net(next(iter(grid.cells_dict.values())))
        )
        self.bodies = pyvista.read(self.folder / order["frames"][0]["bodies"])
        self.payload = self.bodies.extract_cells(self.bodies[PAD] == 0).extract_surface(
            algorithm="dataset_surface"
        )
        self.pads = self.bodies.extract_cells(self.bodies[PAD] > 0).extract_surface(
            algorithm="dataset_surface"
        )
        self.edges, self.corners = (
            self.payload.extract_feature_edges(30),
            self.pads.extract_feature_edges(30),
        )
        self.outline = self.surface.extract_feature_edges(
            30, boundary_edges=False, non_manifold_edges=False
        )
        # Places of the nodes of the outline among those of the surface; deformation does not change
        # them.
        self._along = np.array(
            [self.surface.find_closest_point(place) for place in self.outline.points]
        )

    def show(self, index: int) -> None:
        """Move all parts to frame ``index``."""
        import pyvista

        frame = self.order["frames"][index]
        rails, bodies = (
            pyvista.read(self.folder / frame["rails"]),
            pyvista.read(self.folder / frame["bodies"]),
        )
        self.net.points = self._grid + self.order["factor"] * rails[DISPLACEMENT]
        self.surface.points = self.net.points[self._node]
        self.outline.points = self.surface.points[self._along]
        self.surface["stress"] = 1e-6 * rails[VON_MISES][self._node]
        for part, chosen in ((self.payload, bodies[PAD] == 0), (self.pads, bodies[PAD] > 0)):
            part.points = (
                bodies.extract_cells(chosen).extract_surface(algorithm="dataset_surface").points
            )
        self.edges.points = self.payload.extract_feature_edges(30).points
        self.corners.points = self.pads.extract_feature_edges(30).points

    def fill(self, close: bool, bar: bool) -> None:
        """Put the parts into the present panel; ``close`` shows elements and leaves out the
        payload, which would hide them."""
        from matplotlib.colors import LinearSegmentedColormap

        colours = LinearSegmentedColormap.from_list("stress", _COLOURS)
        look = {
            "title": "von Mises stress (MPa), mean at nodes",
            "color": self.look.ink,
            "vertical": False,
            "position_x": 0.24,
            "position_y": 0.04,
            "width": 0.62,
            "height": 0.11,
            "n_labels": 6,
            "fmt": "%.3g",
            "title_font_size": 17,
            "label_font_size": 15,
        }
        self.plotter.add_mesh(
            self.surface,
            scalars="stress",
            cmap=colours,
            clim=[0.0, 1e-6 * self.order["scale_pa"]],
            show_scalar_bar=bar,
            scalar_bar_args=look if bar else None,
            smooth_shading=False,
            # shade could look like stress
            copy_mesh=False,
            ambient=0.55,
            diffuse=0.5,
        )
        if close:
            net = self.plotter.add_mesh(
                self.net, color=self.look.edge, line_width=1, copy_mesh=False
            )
            # The lines lie in the surface, which would hide parts of them.
            net.mapper.SetResolveCoincidentTopologyToPolygonOffset()
            net.mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, _LIFT)
            self.plotter.add_mesh(self.corners, color=self.look.mark, line_width=2, copy_mesh=False)
        else:
            self.plotter.add_mesh(self.pads, color=self.look.pads, copy_mesh=False)
            self.plotter.add_mesh(
                self.outline, color=self.look.edge, line_width=1.2, copy_mesh=False
            )
            self.plotter.add_mesh(self.payload, color=self.look.body, opacity=0.12, copy_mesh=False)
            self.plotter.add_mesh(self.edges, color=self.look.body, line_width=1.5, copy_mesh=False)

    def write(self, lines: list[str], name: str) -> None:
        """Text in the upper left corner of the present panel, on a background of the paper's
        colour."""
        import pyvista

        text = self.plotter.add_text(
            "\n".join(lines), position="upper_left", font_size=10, color=self.look.ink, name=name
        )
        text.prop.SetBackgroundColor(pyvista.Color(self.look.paper).float_rgb)
        text.prop.SetBackgroundOpacity(0.85)

    def frame_all(self, bounds, zoom: float) -> None:
        """Show everything within ``bounds``, smallest and largest places (m), by parallel
        projection."""
        low, high = np.array(bounds)
        self.plotter.enable_parallel_projection()
        self.plotter.camera_position = [
            tuple(0.5 * (low + high) + np.array(_VIEW)),
            tuple(0.5 * (low + high)),
            (0.0, 0.0, 1.0),
        ]
        self.plotter.reset_camera(bounds=(low[0], high[0], low[1], high[1], low[2], high[2]))
        self.plotter.camera.zoom(zoom)
        # The colour scale is below, so the view is moved up a little.
        camera, shift = (
            self.plotter.camera,
            np.array([0.0, 0.0, -0.07 * self.plotter.camera.parallel_scale]),
        )
        camera.position, camera.focal_point = (
            tuple(camera.position + shift),
            tuple(camera.focal_point + shift),
        )
        self.plotter.add_axes(color=self.look.ink, line_width=2, viewport=(0.0, 0.0, 0.16, 0.26))

    def close_in(self, node: int) -> None:
        """Show a node of the surface, seen from outside the rail and from its open end."""
        place = self.surface.points[node]
        outside = self.surface.compute_normals(
            cell_normals=False, auto_orient_normals=True, split_vertices=False
        )["Normals"][node]
        across = np.array([0.0, *outside[1:]]) / max(np.linalg.norm(outside[1:]), 1e-9)
        tilt = np.array([_ALONG, 0.0, 0.6 * np.sign(place[2]) * (abs(across[2]) < 0.3)])
        self.plotter.enable_parallel_projection()
        self.plotter.camera_position = [
            tuple(place + 0.3 * (across + tilt)),
            tuple(place),
            (0.0, 0.0, 1.0),
        ]
        self.plotter.camera.parallel_scale = _REACH


def still(order: dict, look: Look = LIGHT) -> Path:
    """The instant of the peak stress: everything, and the elements around the worst node."""
    drawing, peak = Drawing(order, _STILL_SIZE, (1, 2), look), order["peak"]
    drawing.show(peak["frame"])
    drawing.plotter.subplot(0, 0)
    drawing.fill(close=False, bar=True)
    drawing.write(_words(order, peak["frame"]), "words")
    drawing.frame_all(_bounds(drawing), 1.0)
    drawing.plotter.subplot(0, 1)
    drawing.fill(close=True, bar=False)
    node = np.linalg.norm(drawing._rest - peak["place_m"], axis=1).argmin()
    drawing.plotter.add_points(
        drawing.surface.points[[node]],
        color=look.mark,
        point_size=18,
        render_points_as_spheres=True,
    )
    place = ", ".join(f"{1e3 * value:.5g}" for value in peak["place_m"])
    drawing.write(
        [
            f"worst node of an element (dot): {1e-6 * peak['stress_pa']:.4g} MPa",
            f"x, y, z = {place} mm",
            f"rail {peak['rail']}; {order['mesh']}; pads in blue",
        ],
        "peak",
    )
    drawing.close_in(int(node))
    path = drawing.folder / f"peak{look.suffix}.png"
    with replacing(path) as temporary:
        drawing.plotter.screenshot(temporary)
    drawing.plotter.close()
    return path


def animation(order: dict, look: Look = LIGHT) -> Path:
    """The whole ejection as an animated WebP of at most LARGEST bytes."""
    from PIL import Image

    drawing = Drawing(order, _SIZE, look=look)
    drawing.show(0)
    drawing.fill(close=False, bar=True)
    drawing.frame_all(order["bounds"], 1.05)
    images = []
    for index in np.unique(
        np.linspace(0, len(order["frames"]) - 1, min(_MOST, len(order["frames"])))
        .round()
        .astype(int)
    ):
        drawing.show(int(index))
        drawing.write(_words(order, int(index)), "words")
        images.append(Image.fromarray(drawing.plotter.screenshot(return_img=True)))
        done = 0.5 * (len(images) / len(order["frames"]) + (look is DARK))
        print(json.dumps({"done": done}), flush=True)
    drawing.plotter.close()
    path = drawing.folder / f"ejection{look.suffix}.webp"
    for quality in (80, 60, 40, 20):
        with replacing(path) as temporary:
            images[0].save(
                temporary,
                format="WEBP",
                save_all=True,
                append_images=images[1:],
                loop=0,
                quality=quality,
                method=4,
                duration=round(1e3 * _SECONDS / len(images)),
            )
        if path.stat().st_size <= LARGEST:
            break
    return path


def _net(cells: np.ndarray) -> np.ndarray:
    """Edges of the facets of a solid of elements (e,k) as lines of pyvista, through the middle
    nodes of quadratic elements."""
    facets = boundary_facets(cells)
    corners = facets[:, :4] if facets.shape[1] == 4 else facets[:, :3]
    parts = [corners, facets[:, corners.shape[1] :], np.roll(corners, -1, axis=1)]
    ends = np.stack([part for part in parts if part.size], axis=-1)
    ends = ends.reshape(-1, ends.shape[-1])
    _, first = np.unique(np.sort(ends, axis=1), axis=0, return_index=True)
    return np.insert(ends[first], 0, ends.shape[1], axis=1).ravel()


def _bounds(drawing: Drawing) -> list[np.ndarray]:
    """Smallest and largest places of the parts that are shown."""
    points = np.concatenate([drawing.surface.points, drawing.payload.points, drawing.pads.points])
    return [points.min(axis=0), points.max(axis=0)]


def _words(order: dict, index: int) -> list[str]:
    return [
        order["title"],
        f"t = {1e3 * order['frames'][index]['time_s']:.2f} ms after ignition",
        f"rail deformation x {order['factor']:g}, payload to scale",
    ]


def main() -> None:
    """Draw the order on standard input; every line of output is JSON."""
    order = json.load(sys.stdin)
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    pictures = [draw(order, look) for look in (LIGHT, DARK) for draw in (still, animation)]
    print(json.dumps({"pictures": [path.name for path in pictures]}), flush=True)


if __name__ == "__main__":
    main()
