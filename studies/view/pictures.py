"""Pictures of a series of frames, drawn off-screen with pyvista: a still of the worst moment, and an animation of the ejection.

Runs as a program of its own (``python -m studies.view.pictures``, an order as JSON on standard input), since a graphics library that
finds no way to draw may end the process it lives in. The rails are drawn deformed by a stated factor, payload and pads to scale.
"""

import json
import os
import sys
from pathlib import Path

import numpy as np

from scenes.files import replacing
from studies.view.vtk_files import DISPLACEMENT, PAD, VON_MISES

STILL, ANIMATION = "peak.png", "ejection.webp"
LARGEST = 3_000_000  # bytes of an animation, which a report carries inside it
_STILL_SIZE, _SIZE = (1500, 620), (840, 430)
_MOST = 120  # frames of an animation
_SECONDS = 6.0  # it lasts
_INK, _BODY, _PADS = "#24292f", "#8a96a3", "#39434e"
_VIEW, _CLOSE = (0.52, -0.80, 0.45), (0.75, -0.55, 0.45)  # from where the eye looks, in platform axes
_COLOURS = "viridis"


class Drawing:
    """One plotter that is moved from frame to frame. ``order`` is what ``studies.stages.view`` asks for."""

    def __init__(self, order: dict, size: tuple[int, int], shape: tuple[int, int] = (1, 1)):
        import pyvista

        self.order, self.folder = order, Path(order["folder"])
        self.plotter = pyvista.Plotter(off_screen=True, window_size=size, shape=shape, border=False)
        self.plotter.set_background("white")
        grid = pyvista.read(self.folder / order["frames"][0]["rails"])
        self.surface = grid.extract_surface(algorithm="dataset_surface")
        self._node, self._rest = self.surface["vtkOriginalPointIds"], self.surface.points.copy()
        self.bodies = pyvista.read(self.folder / order["frames"][0]["bodies"])
        self.payload = self.bodies.extract_cells(self.bodies[PAD] == 0).extract_surface(algorithm="dataset_surface")
        self.pads = self.bodies.extract_cells(self.bodies[PAD] > 0).extract_surface(algorithm="dataset_surface")
        self.edges = self.payload.extract_feature_edges(30)

    def show(self, index: int) -> None:
        """Bring all to frame ``index``."""
        import pyvista

        frame = self.order["frames"][index]
        rails, bodies = pyvista.read(self.folder / frame["rails"]), pyvista.read(self.folder / frame["bodies"])
        self.surface.points = self._rest + self.order["factor"] * rails[DISPLACEMENT][self._node]
        self.surface["stress"] = 1e-6 * rails[VON_MISES][self._node]
        for part, chosen in ((self.payload, bodies[PAD] == 0), (self.pads, bodies[PAD] > 0)):
            part.points = bodies.extract_cells(chosen).extract_surface(algorithm="dataset_surface").points
        self.edges.points = self.payload.extract_feature_edges(30).points

    def fill(self, close: bool, bar: bool) -> None:
        """Put the parts into the present panel; ``close`` shows elements, ``bar`` the colour scale."""
        bar_look = {"title": "von Mises stress (MPa), mean at nodes", "color": _INK, "vertical": False, "position_x": 0.22, "position_y": 0.03,
                    "width": 0.56, "height": 0.075, "n_labels": 5, "fmt": "%.3g", "title_font_size": 17, "label_font_size": 15}
        self.plotter.add_mesh(self.surface, scalars="stress", cmap=_COLOURS, clim=[0.0, 1e-6 * self.order["scale_pa"]], show_edges=close,
                              edge_color="#5b6570", line_width=1, show_scalar_bar=bar, scalar_bar_args=bar_look if bar else None,
                              smooth_shading=False, copy_mesh=False)
        self.plotter.add_mesh(self.payload, color=_BODY, opacity=0.10 if close else 0.18, copy_mesh=False)
        self.plotter.add_mesh(self.edges, color=_BODY, line_width=1.5, copy_mesh=False)
        self.plotter.add_mesh(self.pads, color=_PADS, opacity=0.45 if close else 1.0, copy_mesh=False)

    def write(self, lines: list[str], name: str) -> None:
        """Text in the upper left corner of the present panel."""
        self.plotter.add_text("\n".join(lines), position="upper_left", font_size=9, color=_INK, name=name)

    def frame_all(self) -> None:
        """Look at all rails and the whole way of the payload, seen alike from far away."""
        low, high = np.array(self.order["bounds"])
        self.plotter.enable_parallel_projection()
        self.plotter.camera_position = [tuple(0.5 * (low + high) + np.array(_VIEW)), tuple(0.5 * (low + high)), (0.0, 0.0, 1.0)]
        self.plotter.reset_camera(bounds=(low[0], high[0], low[1], high[1], low[2], high[2]))
        self.plotter.camera.zoom(1.35)
        self.plotter.add_axes(color=_INK, line_width=2, viewport=(0.0, 0.0, 0.16, 0.26))

    def close_in(self) -> None:
        """Look at the place of the peak."""
        place = np.array(self.order["peak"]["place_m"])
        away = np.array(_CLOSE) * [1.0, -1.0 if place[1] < 0.0 else 1.0, 1.0]
        self.plotter.enable_parallel_projection()
        self.plotter.camera_position = [tuple(place + away), tuple(place), (0.0, 0.0, 1.0)]
        self.plotter.camera.parallel_scale = 0.035


def still(order: dict) -> Path:
    """The worst moment: everything, and the elements around the worst corner."""
    drawing, peak = Drawing(order, _STILL_SIZE, (1, 2)), order["peak"]
    drawing.show(peak["frame"])
    drawing.plotter.subplot(0, 0)
    drawing.fill(close=False, bar=True)
    drawing.write(_words(order, peak["frame"]), "words")
    drawing.frame_all()
    drawing.plotter.subplot(0, 1)
    drawing.fill(close=True, bar=False)
    node = np.linalg.norm(drawing._rest - peak["place_m"], axis=1).argmin()
    drawing.plotter.add_points(drawing.surface.points[[node]], color="#d1495b", point_size=16, render_points_as_spheres=True)
    place = ", ".join(f"{1e3 * value:.4g}" for value in peak["place_m"])
    drawing.write([f"worst element corner: {1e-6 * peak['stress_pa']:.4g} MPa", f"x, y, z = {place} mm (rail {peak['rail']})",
                   order["mesh"]], "peak")
    drawing.close_in()
    path = drawing.folder / STILL
    with replacing(path) as temporary:
        drawing.plotter.screenshot(temporary)
    drawing.plotter.close()
    return path


def animation(order: dict) -> Path:
    """The whole ejection, as an animated WebP no larger than LARGEST."""
    from PIL import Image

    drawing = Drawing(order, _SIZE)
    drawing.show(0)
    drawing.fill(close=False, bar=True)
    drawing.frame_all()
    images = []
    for index in np.unique(np.linspace(0, len(order["frames"]) - 1, min(_MOST, len(order["frames"]))).round().astype(int)):
        drawing.show(int(index))
        drawing.write(_words(order, int(index)), "words")
        images.append(Image.fromarray(drawing.plotter.screenshot(return_img=True)))
        print(json.dumps({"done": len(images) / len(order["frames"])}), flush=True)
    drawing.plotter.close()
    path = drawing.folder / ANIMATION
    for quality in (80, 60, 40, 20):
        with replacing(path) as temporary:
            images[0].save(temporary, format="WEBP", save_all=True, append_images=images[1:], loop=0, quality=quality, method=4,
                           duration=round(1e3 * _SECONDS / len(images)))
        if path.stat().st_size <= LARGEST:
            break
    return path


def _words(order: dict, index: int) -> list[str]:
    return [order["title"], f"t = {1e3 * order['frames'][index]['time_s']:.2f} ms after ignition",
            f"rail deformation x {order['factor']:g}, payload to scale"]


def main() -> None:
    """Draw what standard input asks for; every line of output is JSON."""
    order = json.load(sys.stdin)
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    pictures = [still(order), animation(order)]
    print(json.dumps({"pictures": [path.name for path in pictures]}), flush=True)


if __name__ == "__main__":
    main()
