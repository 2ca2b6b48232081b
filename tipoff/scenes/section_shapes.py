"""Sections given by a few numbers. The origin is the middle of each shape's outer rectangle."""

import math
from typing import Annotated, Literal

from pydantic import Discriminator, Field, model_validator

from tipoff.formats.outline import Corner, Loop, Outline, outline
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import Dimension

_BORE_SIDES = 12
_ROD_SIDES = 8


class _ShapeTable(Table):
    """A section with dimensions that fit each other."""

    def outline(self) -> Outline:
        """Its corners. Raises ValueError if its dimensions do not fit each other."""
        return outline(self.loops())

    def loops(self) -> list[list[Corner]]:
        """Corners (m) of its borders."""
        raise NotImplementedError

    def blocks(self) -> tuple[Loop, ...]:
        """Blocks of four anticlockwise corners (m) that fill it; none if they are not known."""
        return ()

    @model_validator(mode="after")
    def _fits(self):
        try:
            self.outline()
        except ValueError as fault:
            raise ValueError(f"dimensions that fit each other: {fault}") from fault
        return self


class TSlotTable(_ShapeTable):
    """``shape = "t_slot"``: a square profile with one T-slot in each side.

    Lips stand over a cavity, whose walls taper at 45 degrees to its floor. So webs of one thickness
    run from the core to the four corners.
    """

    #: Square profile with a T-slot in each side.
    shape: Literal["t_slot"]
    #: Outer width of the profile.
    width: Dimension
    #: Opening of a slot between its lips.
    slot: Dimension
    #: Thickness of a lip.
    lip: Dimension
    #: Width of the cavity behind the lips.
    cavity: Dimension
    #: Depth of the floor of a slot below the outside.
    depth: Dimension
    #: Thickness of the diagonal webs.
    web: Dimension
    #: Diameter of the bore through the core; none where absent.
    bore: Dimension | None = Field(None, exclude_if=is_absent)

    def blocks(self) -> tuple[Loop, ...]:
        if self.bore is not None:
            return ()
        half, slot, inner = 0.5 * self.width, 0.5 * self.slot, 0.5 * self.width - self.lip
        cavity, floor, away = 0.5 * self.cavity, half - self.depth, self.web / math.sqrt(2.0)
        taper, foot = cavity + away, floor - away
        # both ends of the web on the diagonal, moved outwards so that no corner is straight
        end, top = floor - 0.25 * away, taper - 0.25 * away
        # one of the two halves of a quadrant; the other one is its mirror image
        lip = [(cavity, half), (slot, half), (slot, inner), (cavity, inner)]
        beside = [(inner, half), (cavity, half), (cavity, inner), (inner, inner)]
        under = [(inner, inner), (cavity, inner), (cavity, taper), (top, top)]
        web = [(top, top), (cavity, taper), (foot, floor), (end, end)]
        core = [(foot, foot), (foot, floor), (0.0, floor), (0.0, foot)]
        middle = [[(half, half), (inner, half), (inner, inner), (half, inner)]]
        middle += [[(end, end), (foot, floor), (foot, foot), (floor, foot)]]
        middle += [[(0.0, 0.0), (foot, 0.0), (foot, foot), (0.0, foot)]]
        found = [*middle, *(each for each in (lip, beside, under, web, core))]
        found += [[(z, y) for y, z in each[::-1]] for each in (lip, beside, under, web, core)]
        return _turned(found)

    def loops(self) -> list[list[Corner]]:
        half, cavity, floor = 0.5 * self.width, 0.5 * self.cavity, 0.5 * self.width - self.depth
        taper = cavity + self.web / math.sqrt(2.0)  # height at which the cavity begins to taper
        foot = floor - self.web / math.sqrt(2.0)  # half of the floor
        if not (0.5 * self.slot < cavity and foot > 0.0 and taper < half - self.lip):
            raise ValueError(
                "slot < cavity, a floor with a width (depth < width / 2 - 0.71 web), and a cavity that "
                "begins to taper behind the lip (cavity / 2 + 0.71 web < width / 2 - lip)"
            )
        side = [
            (half, half),
            (0.5 * self.slot, half),
            (0.5 * self.slot, half - self.lip),
            (cavity, half - self.lip),
            (cavity, taper),
            (foot, floor),
        ]
        top = side + [(-y, z) for y, z in side[:0:-1]]
        outer = []
        for _ in range(4):
            outer += top
            top = [(-z, y) for y, z in top]
        if self.bore is None:
            return [outer]
        angles = [2.0 * math.pi * (place + 0.5) / _BORE_SIDES for place in range(_BORE_SIDES)]
        # the polygon with the area of the circle
        share = 2.0 * math.pi / _BORE_SIDES
        radius = 0.5 * self.bore * math.sqrt(share / math.sin(share))
        return [outer, [(radius * math.cos(a), radius * math.sin(a)) for a in angles]]


class TeeTable(_ShapeTable):
    """``shape = "tee"``: a flange above, and a web below its middle."""

    #: Flange above, web below its middle.
    shape: Literal["tee"]
    #: Width of the flange, along Y.
    width: Dimension
    #: Whole height, along Z.
    height: Dimension
    #: Thickness of the flange.
    flange: Dimension
    #: Thickness of the web.
    web: Dimension

    def loops(self) -> list[list[Corner]]:
        y, z, web, under = _halves(self.width, self.height, self.web, self.height - 2 * self.flange)
        return [
            [
                (y, z),
                (-y, z),
                (-y, under),
                (-web, under),
                (-web, -z),
                (web, -z),
                (web, under),
                (y, under),
            ]
        ]


class ChannelTable(_ShapeTable):
    """``shape = "channel"``: a web below, and a flange up from each of its ends."""

    #: Web below, a flange up from each of its ends.
    shape: Literal["channel"]
    #: Outer width, along Y.
    width: Dimension
    #: Height of the flanges, with the web, along Z.
    height: Dimension
    #: Thickness of the flanges.
    flange: Dimension
    #: Thickness of the web.
    web: Dimension

    def loops(self) -> list[list[Corner]]:
        y, z, inner, above = _halves(
            self.width, self.height, self.width - 2 * self.flange, 2 * self.web - self.height
        )
        return [
            [
                (-y, -z),
                (y, -z),
                (y, z),
                (inner, z),
                (inner, above),
                (-inner, above),
                (-inner, z),
                (-y, z),
            ]
        ]


class HollowTable(_ShapeTable):
    """``shape = "box"``: a rectangular tube."""

    #: Rectangular tube.
    shape: Literal["box"]
    #: Outer width, along Y.
    width: Dimension
    #: Outer height, along Z.
    height: Dimension
    #: Thickness of the walls.
    wall: Dimension

    def loops(self) -> list[list[Corner]]:
        y, z, wall = 0.5 * self.width, 0.5 * self.height, self.wall
        if wall >= min(y, z):
            raise ValueError("a wall of less than half of the width and of the height")
        return [_rectangle(y, z), _rectangle(y - wall, z - wall)]


class RodTable(_ShapeTable):
    """``shape = "rod"``: a round rod, drawn as an octagon with its second moment.

    With the radius R of the rod, the middles of the sides are 2.7 % of R inside the circle and the corners
    5.3 % outside. The area is 0.11 % smaller. Four sides face along Y and Z.
    """

    #: Round rod, drawn as an octagon with the same second moment.
    shape: Literal["rod"]
    #: Diameter of the rod.
    diameter: Dimension

    def blocks(self) -> tuple[Loop, ...]:
        away, half = rod_side(self.diameter)
        # shares of ``away``, those within by trial for the best shapes
        middle, near, far, side = (0.0, 0.0), (0.3, 0.0), (0.7, 0.0), (1.0, 0.0)
        beside, inner, outer = (0.58, 0.25), (0.27, 0.27), (0.51, 0.51)
        corner, slant = (1.0, half / away), (0.5 + 0.5 * half / away,) * 2
        eighth: list[Loop] = [
            (near, far, beside, inner),
            (far, side, corner, beside),
            (beside, corner, slant, outer),
        ]
        found: list[Loop] = [
            (middle, near, inner, near[::-1]),
            (inner, beside, outer, beside[::-1]),
        ]
        found += eighth
        found += [tuple((z, y) for y, z in each[::-1]) for each in eighth]
        return _turned([[(away * y, away * z) for y, z in each] for each in found])

    def loops(self) -> list[list[Corner]]:
        away, half = rod_side(self.diameter)
        found, side = [], [(away, -half), (away, half)]
        for _ in range(4):
            found += side
            side = [(-z, y) for y, z in side]
        return [found]


def _turned(blocks: list[list[Corner]]) -> tuple[Loop, ...]:
    """The ``blocks`` of a quadrant, and their copies in the other three."""
    every: list[list[Corner]] = []
    for _ in range(4):
        every += blocks
        blocks = [[(-z, y) for y, z in each] for each in blocks]
    return tuple(map(tuple, every))


def rod_side(diameter: float) -> tuple[float, float]:
    """Distance (m) of the sides of a rod of this ``diameter`` (m) from its middle, and half of their width.

    A regular polygon of n sides at the distance a has the second moment n a^4 / 4 (t + t^3 / 3),
    t = tan(pi / n), and the circle pi r^4 / 4.
    """
    slope = math.tan(math.pi / _ROD_SIDES)
    share = math.pi / (_ROD_SIDES * (slope + slope**3 / 3.0))
    away = 0.5 * diameter * share**0.25
    return away, away * slope


def _halves(*lengths: float) -> tuple[float, ...]:
    return tuple(0.5 * length for length in lengths)


def _rectangle(y: float, z: float) -> list[Corner]:
    return [(y, z), (-y, z), (-y, -z), (y, -z)]


ShapeTable = Annotated[
    TSlotTable | RodTable | TeeTable | ChannelTable | HollowTable, Discriminator("shape")
]
SHAPES = ("t_slot", "rod", "tee", "channel", "box")
