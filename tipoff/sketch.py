"""Sketches to scale as SVG in the colours of the page: boxes, arrows, arcs and words in a plane of the
scene."""

import math
from collections.abc import Iterable

from markupsafe import Markup

WIDTH, HEIGHT = 640.0, 330.0  # px


class View:
    """Shapes in a plane of the scene: its first axis to the right, its second one upwards, with
    ``scale`` px per metre from a point of the scene at ``at`` (px)."""

    def __init__(self, at: tuple[float, float], scale: float, centre: tuple[float, float]):
        self.at, self.scale, self.centre = at, scale, centre
        self.shapes: list[str] = []

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Place (px) of a point of the scene (m)."""
        return (
            self.at[0] + self.scale * (x - self.centre[0]),
            self.at[1] - self.scale * (y - self.centre[1]),
        )

    def box(self, kind: str, low: tuple[float, float], high: tuple[float, float]) -> None:
        """A rectangle between two corners (m)."""
        left, bottom = self.point(*low)
        right, top = self.point(*high)
        self.shapes.append(
            f'<rect class="{kind}" x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
            f'height="{bottom - top:.1f}"/>'
        )

    def outline(self, kind: str, loops: Iterable[Iterable[tuple[float, float]]]) -> None:
        """The area of the first of some ``loops`` of corners (m) without the others."""
        path = " ".join(
            f"M {' L '.join('{:.1f} {:.1f}'.format(*self.point(*each)) for each in loop)} z"
            for loop in loops
        )
        self.shapes.append(f'<path class="{kind}" fill-rule="evenodd" d="{path}"/>')

    def corner(
        self,
        kind: str,
        sharp: tuple[float, float],
        ends: tuple[tuple[float, float], tuple[float, float]],
        radius: float,
    ) -> None:
        """The area between a ``sharp`` corner and its fillet of ``radius`` between ``ends`` (m)."""
        (a, b), (c, d), (e, f) = (self.point(*place) for place in (ends[0], sharp, ends[1]))
        size, sweep = self.scale * radius, int((c - a) * (f - d) < (d - b) * (e - c))
        self.shapes.append(
            f'<path class="{kind}" d="M {a:.1f} {b:.1f} L {c:.1f} {d:.1f} L {e:.1f} {f:.1f} '
            f'A {size:.1f} {size:.1f} 0 0 {sweep} {a:.1f} {b:.1f} z"/>'
        )

    def arrow(
        self, begin: tuple[float, float], end: tuple[float, float], kind: str = "axis"
    ) -> None:
        """An arrow between two places (px)."""
        (a, b), (c, d) = begin, end
        self.shapes.append(
            f'<line class="{kind}" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}" '
            f'marker-end="url(#tip)"/>'
        )

    def line(self, begin: tuple[float, float], end: tuple[float, float], kind: str) -> None:
        """A line between two places (px)."""
        (a, b), (c, d) = begin, end
        self.shapes.append(
            f'<line class="{kind}" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}"/>'
        )

    def arc(self, begin: float, end: float, radius: float, kind: str) -> None:
        """An arc with an arrow about the centre; angles (rad) from the first axis to the second,
        ``radius`` in px."""
        (a, b), (c, d) = (
            (
                self.at[0] + radius * math.cos(angle),
                self.at[1] - radius * math.sin(angle),
            )
            for angle in (begin, end)
        )
        sweep = 0 if end > begin else 1
        self.shapes.append(
            f'<path class="{kind}" d="M {a:.1f} {b:.1f} A {radius:.1f} {radius:.1f} 0 0 {sweep} '
            f'{c:.1f} {d:.1f}" marker-end="url(#tip)"/>'
        )

    def text(self, place: tuple[float, float], words: str, anchor: str = "middle") -> None:
        """Words at a place (px)."""
        self.shapes.append(
            str(
                Markup('<text x="{}" y="{}" text-anchor="{}">{}</text>').format(
                    f"{place[0]:.1f}", f"{place[1]:.1f}", anchor, words
                )
            )
        )

    def dimension(self, begin: tuple[float, float], end: tuple[float, float], words: str) -> None:
        """A line with arrows at both ends between two places (px), and words beside its middle:
        above a horizontal line, to the right of a vertical one."""
        (a, b), (c, d) = begin, end
        self.shapes.append(
            f'<line class="size" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}" '
            f'marker-start="url(#tip)" marker-end="url(#tip)"/>'
        )
        if abs(c - a) >= abs(d - b):
            self.text((0.5 * (a + c), min(b, d) - 6.0), words)
        else:
            self.text((max(a, c) + 6.0, 0.5 * (b + d) + 4.0), words, "start")

    def dot(self, place: tuple[float, float], words: str) -> None:
        """A point at a place (px), with words below it."""
        self.shapes.append(f'<circle class="dot" cx="{place[0]:.1f}" cy="{place[1]:.1f}" r="4"/>')
        self.text((place[0], place[1] + 18.0), words)

    def guide(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """A thin line between two places (px), from a part to its dimension."""
        (a, b), (c, d) = begin, end
        self.shapes.append(
            f'<line class="guide" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}"/>'
        )


def svg(title: str, shapes: Iterable[str]) -> str:
    """The SVG of ``shapes``; ``title`` is for a reader who does not see it."""
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{title}">'
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto-start-reverse"><path class="tip" d="M0 0 8 4 0 8z"/>'
        f"</marker></defs>{''.join(shapes)}</svg>"
    )
