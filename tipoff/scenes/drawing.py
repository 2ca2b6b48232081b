"""A drawing of the launcher to scale, as SVG in the colours of the page: seen from the side, and from
the open end with the clock angles.

Two conventions of clock angles are in use, and the drawing has both: the tilt of the thrust counts
from +Y towards +Z, an eccentricity from +Z towards +Y.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from tipoff.scenes import guides
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.rail_base import HeldBySpans
from tipoff.sketch import HEIGHT, WIDTH, View, svg

if TYPE_CHECKING:
    from tipoff.plots import Figure

_EDGE = 46.0  # px
_ROUND = 72  # corners of a round body
Make = Callable[[tuple[float, float], float, tuple[float, float]], View]


def launcher(scene: Any) -> Markup:
    """Both views with their labels as HTML."""
    # safe: all markup is made here, and the scene gives numbers only
    return Markup(
        '<div class="drawing">'
        f"{svg('Launcher from the side', _side(scene))}{svg('From the open end', _end(scene))}"
        "</div>"
    )


def figure(scene: Any) -> "Figure":
    """Both views as a figure of matplotlib."""
    from tipoff import plots  # slow to load

    found, (side, end) = plots.sheets((WIDTH, HEIGHT), scene.name)
    _side(scene, side)
    _end(scene, end)
    return found


def halves(scene: Any) -> tuple[float, float, float]:
    """Half sizes (m) of the payload; of the box around its pads if it has no size."""
    pads = [max(abs(pad.position[axis]) for pad in scene.pads) for axis in range(3)]
    size = scene.payload.size
    return (
        (0.5 * size[0], 0.5 * size[1], 0.5 * size[2]) if size else (1.3 * pads[0], pads[1], pads[2])
    )


def ends(scene: Any) -> tuple[float, float]:
    """X (m) of tail and nose of the payload: where its places are counted from, or with the mass centre in
    the middle."""
    length, centre = scene.payload.length, scene.payload.mass_centre
    if scene.origin is None or length is None or centre is None:
        half = halves(scene)[0]
        return -half, half
    tail = -centre if scene.origin == "tail" else centre - length
    return tail, tail + length


def height(scene: Any) -> int:
    """Axis that the view from the side shows upwards: Z of a payload above or below a single rail, else Y."""
    is_single = isinstance(scene.rail, ProfileTable) and len(list(scene.rail.images())) == 1
    return 2 if is_single else 1


def side_view(scene: Any, make: Make = View) -> View:
    """Payload, rails, mounts and pads to scale, X to the right and the axis of ``height`` upwards."""
    up = height(scene)
    (tail, nose), b = ends(scene), halves(scene)[up]
    arm = getattr(scene.thrust, "arm", 0.0) or 0.0
    wall = thickness(scene)
    low, high = min(scene.rail.start, tail, -arm), max(scene.rail.end, nose)
    reach = max([b, *(abs(place) for corner in _corners(scene) for place in corner)])
    scale = min(
        (WIDTH - 2 * _EDGE - 60.0) / (high - low), (HEIGHT - 154.0) / (2.0 * reach + 4.0 * wall)
    )
    view = make((0.5 * WIDTH + 20.0, 0.5 * HEIGHT - 8.0), scale, (0.5 * (low + high), 0.0))
    view.box("payload", (tail, -b), (nose, b))
    for near, far in _across(scene, up):
        view.box("rail", (scene.rail.start, near), (scene.rail.end, far))
        for begin, end in _mounts(scene):
            outside = (near - 1.2 * wall, near) if near + far < 0.0 else (far, far + 1.2 * wall)
            view.box("mount", (begin, outside[0]), (end, outside[1]))
    for x, y, length in dict.fromkeys(
        (pad.position[0], pad.position[up], pad.length) for pad in scene.pads
    ):
        inner = sorted((y, y - math.copysign(0.35 * length, y)))
        view.box("pad", (x - 0.5 * length, inner[0]), (x + 0.5 * length, inner[1]))
    return view


def _side(scene: Any, make: Make = View) -> list[str]:
    view, up, wall = side_view(scene, make), height(scene), thickness(scene)
    (tail, nose), b = ends(scene), halves(scene)[up]
    arm = getattr(scene.thrust, "arm", 0.0) or 0.0
    tip = view.point(-arm, 0.0)
    view.arrow((tip[0] - 56.0, tip[1]), tip, "thrust")
    pushed = "springs" if isinstance(scene.thrust, PushedTable) else "thrust"
    view.text((tip[0] - 30.0, tip[1] - 14.0), pushed)
    origin = view.point(0.0, 0.0)
    view.arrow(origin, (origin[0] + 60.0, origin[1]))
    view.text((origin[0] + 70.0, origin[1] + 4.0), "X")
    view.arrow(origin, (origin[0], origin[1] - 44.0))
    view.text((origin[0] + 10.0, origin[1] - 38.0), "XYZ"[up])
    _loads(view, scene, up)
    corner = view.point(scene.rail.end, b + wall)
    view.text((corner[0], corner[1] - 26.0), "open end")
    _names(view, scene, up, wall)
    view.text((_EDGE, 20.0), "From the side", "start")
    travel = 1e3 * (scene.rail.end - scene.rail.start)
    view.text(
        (0.5 * WIDTH, HEIGHT - 26.0),
        f"rail {travel:.4g} mm, payload {1e3 * (nose - tail):.4g} mm; to scale",
    )
    view.text((0.5 * WIDTH, HEIGHT - 8.0), _play(scene))
    return view.shapes


def _loads(view: View, scene: Any, up: int) -> None:
    """Mass centre and line of the thrust, with their offsets in words."""
    arm, words = getattr(scene.thrust, "arm", 0.0) or 0.0, []
    shift = scene.mass_offset.eccentricity.offset() if scene.mass_offset else (0.0, 0.0, 0.0)
    view.dot(view.point(0.0, shift[up]), "mass centre")
    if scene.mass_offset is not None:
        words.append(f"mass centre {1e3 * math.hypot(*shift):.3g} mm off the axis")
    if (offset := scene.thrust_offset) is not None:
        line, along = offset.eccentricity.offset(), offset.misalignment.direction()
        slope = along[up] / along[0]
        begin, end = (view.point(x, line[up] + (x + arm) * slope) for x in (-arm, ends(scene)[1]))
        view.line(begin, end, "tilt")
        tilt = math.degrees(math.atan2(math.hypot(*along[1:]), along[0]))
        words.append(
            f"thrust tilted by {tilt:.3g} deg, {1e3 * math.hypot(*line):.3g} mm off the axis"
        )
    if words:
        view.text((0.5 * WIDTH, HEIGHT - 44.0), "; ".join(words))


def _play(scene: Any) -> str:
    """The play, which is too small to be drawn."""
    if scene.contact is None:
        return "no contact: the play does not matter"
    _, y, z = (1e3 * gap for gap in scene.contact.gaps())
    each = f"{y:.3g} mm" if y == z else f"{y:.3g} mm along Y, {z:.3g} mm along Z"
    return f"play of each pad: {each}, not drawn"


def _names(view: View, scene: Any, up: int, wall: float) -> None:
    """The names of the parts beside one of each: rail, mount, pad or button."""
    lowest, bottom = min(_across(scene, up))[0], min(pad.position[up] for pad in scene.pads)
    end = view.point(scene.rail.end, lowest)
    view.text((end[0] + 5.0, end[1] + 15.0), "rail", "start")
    for low, high in _mounts(scene)[:1]:
        place = view.point(0.5 * (low + high), lowest - 1.2 * wall)
        view.text((place[0], place[1] + 15.0), "mount (fixed)")
    for guide in guides.from_pads(scene.pads):
        pad = scene.pads[guide.pads[0]]
        if guide.foot is None:
            continue
        place = view.point(pad.position[0], 0.0)
        view.text((place[0], place[1] - 16.0), guide.name)
    if not any(pad.foot for pad in scene.pads):
        pad = min(scene.pads, key=lambda pad: (-pad.position[0], pad.position[up]))
        place = view.point(pad.position[0], bottom)
        view.text((place[0], place[1] - 16.0), "pad")


def end_view(scene: Any, make: Make = View) -> View:
    """Payload, rails and pads to scale, seen from the open end: Y to the right and Z upwards."""
    _, b, c = halves(scene)
    wall, leg = thickness(scene), _leg(scene)
    reach = max([b, c, *(abs(place) for corner in _corners(scene) for place in corner)])
    scale = (HEIGHT - 110.0) / (2.0 * reach + 4.0 * wall)
    view = make((0.32 * WIDTH, 0.5 * HEIGHT), scale, (0.0, 0.0))
    if scene.payload.diameter is None:
        view.box("payload", (-b, -c), (b, c))
    else:
        angles = [2.0 * math.pi * share / _ROUND for share in range(_ROUND)]
        loop = [(b * math.cos(angle), c * math.sin(angle)) for angle in angles]
        view.outline("payload", [loop])
    if isinstance(scene.rail, ProfileTable):
        for image in scene.rail.images():
            view.outline("rail", image.loops)
    for y in (-1.0, 1.0):
        for z in (-1.0, 1.0):
            if isinstance(scene.rail, SectionTable):
                rail_corner(view, (y, z), (b, c), leg, wall, scene.rail.fillet or 0.0)
    for pad in dict.fromkeys(
        (pad.position[1:], pad.normals, pad.width, pad.inset) for pad in scene.pads
    ):
        _pad(view, *pad)
    return view


def _end(scene: Any, make: Make = View) -> list[str]:
    view, (_, b, c) = end_view(scene, make), halves(scene)
    at, reach = view.at, view.scale * max(b, c)
    view.arrow(at, (at[0] + reach + 52.0, at[1]))
    view.text((at[0] + reach + 62.0, at[1] + 4.0), "Y")
    view.arrow(at, (at[0], at[1] - reach - 34.0))
    view.text((at[0] + 12.0, at[1] - reach - 26.0), "Z")
    view.text((at[0] - 10.0, at[1] + 16.0), "X towards you")
    _errors(view, scene, 0.9 * view.scale * min(b, c))
    first, second = math.radians(4.0), math.radians(56.0)
    view.arc(first, second, 0.72 * reach, "tilt")
    view.arc(math.radians(86.0), math.radians(34.0), 0.46 * reach, "shift")
    left = at[0] + reach + 84.0
    for row, (kind, lines) in enumerate(_LEGEND.items()):
        y = 0.30 * HEIGHT + 92.0 * row
        view.line((left, y - 4.0), (left + 24.0, y - 4.0), kind)
        for line, words in enumerate(lines):
            view.text((left + (32.0 if not line else 0.0), y + 18.0 * line), words, "start")
    view.text((_EDGE, 20.0), "From the open end: clock angles", "start")
    return view.shapes


def _errors(view: View, scene: Any, reach: float) -> None:
    """The tilt of the thrust to its clock angle, and its line and the mass centre beside the axis: the larger
    distance, or the tilt, is drawn ``reach`` (px) long."""
    offset, shift = scene.thrust_offset, scene.mass_offset
    points = {} if shift is None else {"mass centre": shift.eccentricity.offset()[1:]}
    if offset is not None:
        points["line of thrust"] = offset.eccentricity.offset()[1:]
        tilt = offset.misalignment.direction()[1:]
        if size := math.hypot(*tilt):
            y, z = (reach * part / size for part in tilt)
            view.arrow(view.at, (view.at[0] + y, view.at[1] - z), "thrust")
    largest = max((math.hypot(*point) for point in points.values()), default=0.0)
    for name, (y, z) in points.items():
        if largest and (y or z):
            scale = reach / largest
            view.dot((view.at[0] + scale * y, view.at[1] - scale * z), name)
    if largest:
        words = f"errors enlarged: {1e3 * largest:.3g} mm off the axis at the farthest point"
        view.text((view.at[0], HEIGHT - 8.0), words)


_LEGEND = {
    "tilt": ("tilt of the thrust:", "from +Y towards +Z", "thrust_offset.misalignment"),
    "shift": (
        "eccentricities:",
        "from +Z towards +Y",
        "thrust_offset.eccentricity,",
        "mass_offset.eccentricity",
    ),
}


def rail_corner(
    view: View,
    signs: tuple[float, float],
    half: tuple[float, float],
    leg: float,
    wall: float,
    fillet: float = 0.0,
) -> None:
    """The two legs of an L around one edge of the payload, and the fillet between them (m)."""
    (y, z), (b, c) = signs, half
    spans = {
        "across": (sorted((y * b, y * (b + wall))), sorted((z * (c + wall), z * (c + wall - leg)))),
        "along": (sorted((y * (b + wall), y * (b + wall - leg))), sorted((z * c, z * (c + wall)))),
    }
    for (left, right), (bottom, top) in spans.values():
        view.box("rail", (left, bottom), (right, top))
    if fillet:
        ends = (y * (b - fillet), z * c), (y * b, z * (c - fillet))
        view.corner("rail", (y * b, z * c), ends, fillet)


def _pad(
    view: View, corner: tuple[float, float], normals: tuple[str, ...], width: float, inset: float
) -> None:
    """The faces of a pad as bars of its width, ``inset`` from its corner."""
    y, z = corner
    for normal in normals:
        depth = 0.12 * width
        if normal.endswith("y"):
            middle, inner = z - math.copysign(inset, z), y - math.copysign(depth, y)
            (left, right), (bottom, top) = (
                sorted((y, inner)),
                (middle - 0.5 * width, middle + 0.5 * width),
            )
        else:
            middle, inner = y - math.copysign(inset, y), z - math.copysign(depth, z)
            (left, right), (bottom, top) = (
                (middle - 0.5 * width, middle + 0.5 * width),
                sorted((z, inner)),
            )
        view.box("pad", (left, bottom), (right, top))


def thickness(scene: Any) -> float:
    """Thickness (m) of a drawn wall: its own, or a twentieth of the payload's width."""
    own = getattr(scene.rail, "thickness", None)
    return own or 0.05 * halves(scene)[1]


def _corners(scene: Any) -> list[tuple[float, float]]:
    """Corners (m) of rails that have a section of their own."""
    rails = scene.rail.images() if isinstance(scene.rail, ProfileTable) else []
    return [corner for rail in rails for corner in rail.loops[0]]


def _across(scene: Any, up: int) -> list[tuple[float, float]]:
    """From and to (m) along the axis ``up`` of the rails as seen from the side."""
    if isinstance(scene.rail, ProfileTable):
        places = [[corner[up - 1] for corner in rail.loops[0]] for rail in scene.rail.images()]
        return [(min(each), max(each)) for each in places]
    b, wall = halves(scene)[up], thickness(scene)
    return [(-b - wall, -b), (b, b + wall)]


def _leg(scene: Any) -> float:
    return scene.rail.leg if isinstance(scene.rail, SectionTable) else 0.0


def _mounts(scene: Any) -> list[tuple[float, float]]:
    """Intervals (m) along X at which a rail of one section is held."""
    if not isinstance(scene.rail, HeldBySpans):
        return []
    start = scene.rail.start
    return [(start + span.start, start + span.end) for span in scene.rail.mounts]
