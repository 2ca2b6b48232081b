"""Drawings of the tables of a scene that have geometry, each length and angle named by its key.

The launcher is the scene ``reference``, drawn by the code of the report. Clearance, tilt and offsets
are drawn larger than they are.
"""

import math
from collections.abc import Callable

import tipoff
from tipoff.scenes.drawing import end_view, halves, rail_corner, side_view, thickness
from tipoff.sketch import HEIGHT, WIDTH, View, svg

_SCENE = tipoff.load("reference")
_FILLET = 0.004  # m, as drawn
_LEFT = 20.0  # px, of titles


def of(heading: str) -> str:
    """HTML of the drawings of the table that has this heading on the page; empty without any."""
    views = [
        svg(f"Keys of {table.split('`')[1]}", make().shapes)
        for table, makes in _DRAWN.items()
        for make in makes
        if heading == table
    ]
    return f'<div class="drawing">{"".join(views)}</div>\n\n' if views else ""


def _titled(view: View, title: str) -> View:
    view.text((_LEFT, 20.0), title, "start")
    return view


def _across(view: View, keys: dict[str, tuple[float, float]], level: float, y: float) -> None:
    """Horizontal dimensions between places along X (m) at ``level`` (px), guides from ``y`` (m)."""
    for words, (begin, end) in keys.items():
        (left, from_), (right, _) = view.point(begin, y), view.point(end, y)
        for x in (left, right):
            view.guide((x, from_), (x, level))
        view.dimension((left, level), (right, level), words)


def _size() -> View:
    view, (a, b, _) = side_view(_SCENE), halves(_SCENE)
    bottom = view.point(0.0, -b - 2.2 * thickness(_SCENE))[1]
    _across(view, {"size[0]": (-a, a)}, bottom + 26.0, -b)
    x = view.point(0.8 * a, 0.0)[0]
    view.dimension((x, view.point(0.0, -b)[1]), (x, view.point(0.0, b)[1]), "size[1]")
    centre = view.point(0.0, 0.0)
    view.dot(centre, "nominal mass centre: the origin")
    return _titled(view, "[payload] from the side")


def _size_across() -> View:
    view, (_, b, c) = end_view(_SCENE), halves(_SCENE)
    wall = thickness(_SCENE)
    (left, bottom), (right, top) = view.point(-b, -c - wall), view.point(b, c)
    view.dimension((left, bottom + 28.0), (right, bottom + 28.0), "size[1]")
    x = view.point(b + wall, 0.0)[0] + 20.0
    view.dimension((x, view.point(0.0, -c)[1]), (x, top), "size[2]")
    return _titled(view, "[payload] from the open end")


def _stations() -> View:
    view, (_, b, _) = side_view(_SCENE), halves(_SCENE)
    pad = next(pad for pad in _SCENE.pads if pad.position[0] > 0.0 and pad.position[1] > 0.0)
    x, y, _ = pad.position
    top = view.point(0.0, b + 2.2 * thickness(_SCENE))[1]
    _across(view, {"length": (x - 0.5 * pad.length, x + 0.5 * pad.length)}, top - 10.0, y)
    _across(view, {"position[0], stations": (0.0, x)}, view.point(0.0, 0.3 * b)[1], y)
    at = view.point(-0.08, 0.0)[0] - 44.0
    view.dimension((at, view.point(0.0, 0.0)[1]), (at, view.point(0.0, y)[1]), "position[1]")
    view.dot(view.point(0.0, 0.0), "nominal mass centre")
    return _titled(view, "[[pads]] from the side")


def _faces() -> View:
    """One corner of the payload, as the keys of a face need it."""
    pad = next(pad for pad in _SCENE.pads if min(pad.position[1:]) > 0.0)
    (y, z), scale = pad.position[1:], 5200.0
    view = View((0.60 * WIDTH, 0.34 * HEIGHT), scale, (y, z))
    view.box("payload", (y - 0.036, z - 0.036), (y - 0.0012, z - 0.0012))
    low, high = pad.inset - 0.5 * pad.width, pad.inset + 0.5 * pad.width
    view.box("pad", (y - 0.002, z - high), (y, z - low))
    view.box("pad", (y - high, z - 0.002), (y - low, z))
    corner = view.point(y, z)
    view.dot(corner, "")
    view.text((corner[0] + 8.0, corner[1] - 10.0), "position, corner", "start")
    right = corner[0] + 34.0
    for place in (low, high, pad.inset, 0.0):
        level = view.point(y, z - place)[1]
        view.guide((corner[0], level), (right + (60.0 if place in (low, high) else 0.0), level))
    view.dimension((right, corner[1]), (right, view.point(y, z - pad.inset)[1]), "inset")
    further = right + 60.0
    view.dimension(
        (further, view.point(y, z - low)[1]), (further, view.point(y, z - high)[1]), "width"
    )
    view.text((view.point(y - high, z)[0], corner[1] - 8.0), 'face "+z"')
    face = view.point(y - 0.002, z - pad.inset)
    view.text((face[0] - 6.0, face[1]), 'face "+y"', "end")
    return _titled(view, "[[pads]]: one corner from the open end")


def _rail() -> View:
    view, (_, b, _) = side_view(_SCENE), halves(_SCENE)
    rail, wall = _SCENE.rail, thickness(_SCENE)
    top = view.point(0.0, b + 2.2 * wall)[1]
    _across(view, {"start (negative)": (rail.start, 0.0), "end": (0.0, rail.end)}, top - 14.0, b)
    view.text((view.point(rail.end, b)[0] + 10.0, top + 20.0), "open end", "start")
    span = rail.mounts[1]
    low, high = rail.start + span.start, rail.start + span.end
    bottom = view.point(0.0, -b - 2.2 * wall)[1]
    _across(view, {"mounts: start": (rail.start, low)}, bottom + 28.0, -b - wall)
    _across(view, {"": (rail.start, high)}, bottom + 48.0, -b - wall)
    view.text((view.point(high, 0.0)[0] + 8.0, bottom + 52.0), "mounts: end", "start")
    view.dot(view.point(0.0, 0.0), "nominal mass centre")
    return _titled(view, "[rail] from the side")


def _zoomed(gap: float, fillet: float = 0.0) -> View:
    """The section of one rail around its corner of the payload, ``gap`` (m) off it."""
    _, b, c = halves(_SCENE)
    view = View((0.56 * WIDTH, 0.36 * HEIGHT), 5200.0, (b, c))
    view.box("payload", (b - 0.036, c - 0.036), (b, c))
    rail = _SCENE.rail
    rail_corner(view, (1.0, 1.0), (b + gap, c + gap), rail.leg, rail.thickness, fillet)
    return view


def _section() -> View:
    view, (_, b, c), rail = _zoomed(0.0, _FILLET), halves(_SCENE), _SCENE.rail
    outer = (b + rail.thickness, c + rail.thickness)
    level = view.point(*outer)[1] - 16.0
    _across(view, {"leg": (outer[0] - rail.leg, outer[0])}, level, outer[1])
    strip = 0.0008  # m, as drawn
    view.box("mount", (outer[0] - rail.mount_width, outer[1]), (outer[0], outer[1] + strip))
    view.box("mount", (outer[0], outer[1] - rail.mount_width), (outer[0] + strip, outer[1]))
    side = view.point(*outer)[0] + 16.0
    ends = [view.point(0.0, outer[1] - part)[1] for part in (0.0, rail.mount_width)]
    view.dimension((side, ends[0]), (side, ends[1]), "mount_width")
    foot = view.point(b, outer[1] - rail.leg)[1] + 20.0
    _across(view, {"": (b, outer[0])}, foot, outer[1] - rail.leg)
    view.text((view.point(outer[0], 0.0)[0] + 6.0, foot + 4.0), "thickness", "start")
    centre = view.point(b - _FILLET, c - _FILLET)
    tip = view.point(*(place - _FILLET * (1.0 - math.sqrt(0.5)) for place in (b, c)))
    view.arrow(centre, tip)
    view.text((centre[0] - 6.0, centre[1] + 12.0), "fillet", "end")
    return _titled(view, "[rail], section of one rail from the open end")


def _clearance() -> View:
    gap = 0.004  # m, as drawn
    view, (_, b, c), pad = _zoomed(gap), halves(_SCENE), _SCENE.pads[0]
    near, far = pad.inset - 0.5 * pad.width, pad.inset + 0.5 * pad.width
    view.box("pad", (b - 0.002, c - far), (b, c - near))
    view.box("pad", (b - far, c - 0.002), (b - near, c))
    y = view.point(0.0, c - pad.inset)[1]
    view.dimension((view.point(b, c)[0], y), (view.point(b + gap, c)[0], y), "")
    view.text((view.point(b + gap + 0.005, c)[0], y + 4.0), "clearance, clearance_y", "start")
    x = view.point(b - far - 0.005, c)[0]
    view.guide((x, view.point(b, c + gap)[1]), view.point(b - far, c + gap))
    view.dimension((x, view.point(b, c)[1]), (x, view.point(b, c + gap)[1]), "")
    view.text((x - 8.0, view.point(b, c + 0.5 * gap)[1] + 4.0), "clearance, clearance_z", "end")
    view.text((view.point(b - 0.004, c)[0], view.point(b, c - far)[1] + 14.0), "pad", "end")
    return _titled(view, "[contact]: pad and wall; the clearance is drawn larger than it is")


def _thrust() -> View:
    view, (_, b, _) = side_view(_SCENE), halves(_SCENE)
    arm, offset, tilt = _SCENE.thrust.arm, 0.28 * b, math.radians(14.0)
    centre, tip = view.point(0.0, 0.0), view.point(-arm, offset)
    length = 150.0
    end = (tip[0] + length * math.cos(tilt), tip[1] - length * math.sin(tilt))
    view.guide((tip[0], tip[1]), (tip[0] + length + 30.0, tip[1]))
    view.arrow(tip, end, "thrust")
    turned = View(tip, 1.0, (0.0, 0.0))
    turned.arc(0.0, tilt, 0.8 * length, "tilt")
    view.shapes += turned.shapes
    view.text((end[0] + 8.0, tip[1] - 12.0), "misalignment.axial", "start")
    axis = view.point(-arm, 0.0)
    view.guide(axis, centre)
    view.dimension((tip[0] - 8.0, axis[1]), (tip[0] - 8.0, tip[1]), "")
    view.text((tip[0] - 14.0, 0.5 * (axis[1] + tip[1]) + 4.0), "eccentricity.axial", "end")
    _across(view, {"thrust.arm": (-arm, 0.0)}, axis[1] + 48.0, 0.0)
    view.dot(centre, "nominal mass centre")
    return _titled(view, "[thrust_offset] and the arm of [thrust] from the side")


def _clock(kind: str, table: str, key: str) -> View:
    """A clock angle from the open end: that of a tilt from +Y, that of an offset from +Z."""
    view, (_, b, c) = end_view(_SCENE), halves(_SCENE)
    at, reach = view.at, view.scale * max(b, c)
    view.arrow(at, (at[0] + reach + 40.0, at[1]))
    view.text((at[0] + reach + 50.0, at[1] + 4.0), "Y")
    view.arrow(at, (at[0], at[1] - reach - 30.0))
    view.text((at[0] + 12.0, at[1] - reach - 22.0), "Z")
    begin, end = (2.0, 35.0) if kind == "tilt" else (88.0, 55.0)
    angle, length = math.radians(end), 0.8 * reach
    tip = (at[0] + length * math.cos(angle), at[1] - length * math.sin(angle))
    view.arrow(at, tip, kind)
    view.arc(math.radians(begin), angle, 0.5 * reach, kind)
    middle = math.radians(0.5 * (begin + end))
    side = at[0] + reach + 62.0
    bend = (at[0] + 0.5 * reach * math.cos(middle), at[1] - 0.5 * reach * math.sin(middle))
    view.guide(bend, (side, bend[1]))
    view.text((side + 4.0, bend[1] + 4.0), f"{key}.radial", "start")
    if kind == "shift":
        view.guide(tip, (side, tip[1] - 30.0))
        view.text((side + 4.0, tip[1] - 26.0), f"{key}.axial: its length", "start")
    return _titled(view, f"[{table}] from the open end, X towards you")


def _tilt() -> View:
    return _clock("tilt", "thrust_offset.misalignment", "misalignment")


def _line() -> View:
    return _clock("shift", "thrust_offset.eccentricity", "eccentricity")


def _mass() -> View:
    return _clock("shift", "mass_offset.eccentricity", "eccentricity")


def _platform() -> View:
    """The mass centre of the platform alone: a scene has no shape of it."""
    view, (_, b, _) = side_view(_SCENE), halves(_SCENE)
    x, y = -0.10, -0.6 * b
    origin, centre = view.point(0.0, 0.0), view.point(x, y)
    beside = origin[0] + 24.0
    view.dot(centre, "platform")
    view.dot(origin, "")
    view.text((origin[0] + 10.0, origin[1] - 8.0), "nominal mass centre", "start")
    _across(view, {"mass_centre.x (negative)": (x, 0.0)}, origin[1] - 34.0, 0.0)
    view.guide((origin[0], origin[1]), (beside, origin[1]))
    view.guide(centre, (beside, centre[1]))
    view.dimension((beside, origin[1]), (beside, centre[1]), "mass_centre.y (negative)")
    return _titled(view, "[platform]: mass centre of the platform with its rails")


_DRAWN: dict[str, tuple[Callable[[], View], ...]] = {
    "`[payload]`": (_size, _size_across),
    "`[[pads]]`": (_stations, _faces),
    "`[rail]`, built-in section": (_rail, _section),
    "`[thrust_offset]`": (_thrust,),
    "`[thrust_offset.misalignment]`": (_tilt,),
    "`[thrust_offset.eccentricity]`": (_line,),
    "`[mass_offset.eccentricity]`": (_mass,),
    '`[contact]`, `law = "impact"`': (_clearance,),
    "`[platform]`": (_platform,),
}
