"""Outline of a section: one outer border and any number of holes, each a polygon.

With corners (y_k, z_k) in order, metal on the left, and c_k = y_k z_k+1 - y_k+1 z_k:

    A = 1/2 sum c_k,   A y_0 = 1/6 sum c_k (y_k + y_k+1),   J_yy = 1/12 sum c_k (y_k^2 + y_k y_k+1 + y_k+1^2)

and likewise for z. J_yy and J_zz are the integrals of y^2 and z^2 about the centroid: J_yy is the
second moment for bending along Y.

Source: Soerjadi, On the computation of the moments of a polygon, with some applications, Heron
16(5), 1968.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

Corner = tuple[float, float]
Loop = tuple[Corner, ...]

MOST_CORNERS = 400  # of all loops: every side is compared with every other one
SHORTEST = 1e-5  # m, of a side
SAME = 1e-6  # m: a point closer to a side lies on it


class Side(NamedTuple):
    """A straight side from one corner to the next, metal on the left."""

    start: Corner  # m
    end: Corner  # m

    @property
    def normal(self) -> Corner:
        """Unit vector away from the metal."""
        y, z = self.end[0] - self.start[0], self.end[1] - self.start[1]
        return z / math.hypot(y, z), -y / math.hypot(y, z)

    def words(self) -> str:
        """Both ends in mm."""
        return " to ".join(f"({1e3 * y:.6g}, {1e3 * z:.6g})" for y, z in self) + " mm"


class Moments(NamedTuple):
    """Area and moments of a section about its centroid."""

    area: float  # m2
    y: float  # m, of the centroid
    z: float  # m, of the centroid
    yy: float  # m4, integral of y^2
    zz: float  # m4, integral of z^2
    yz: float  # m4, integral of y z


class Outline(NamedTuple):
    """Loops of corners (m) along Y and Z, metal on the left: the outer border first, counter-clockwise,
    then the holes, clockwise."""

    loops: tuple[Loop, ...]

    def sides(self) -> list[Side]:
        """All sides, loop by loop."""
        return [
            Side(start, end) for loop in self.loops for start, end in zip(loop, loop[1:] + loop[:1])
        ]

    def moments(self) -> Moments:
        """Area and moments."""
        y, z = np.array([[side.start, side.end] for side in self.sides()]).transpose(2, 1, 0)
        cross = y[0] * z[1] - y[1] * z[0]
        area = 0.5 * cross.sum()
        middle = [(cross * each.sum(axis=0)).sum() / (6.0 * area) for each in (y, z)]
        yy, zz = ((cross * (a * a + a * b + b * b)).sum() / 12.0 for a, b in (y, z))
        yz = (cross * (y[0] * (2.0 * z[0] + z[1]) + y[1] * (z[0] + 2.0 * z[1]))).sum() / 24.0
        return Moments(
            float(area),
            float(middle[0]),
            float(middle[1]),
            float(yy - area * middle[0] ** 2),
            float(zz - area * middle[1] ** 2),
            float(yz - area * middle[0] * middle[1]),
        )

    def at(self, place: Corner) -> "Outline":
        """The outline with its origin moved to ``place`` (m)."""
        y, z = place
        return Outline(tuple(tuple((a + y, b + z) for a, b in loop) for loop in self.loops))

    def mirrored(self, y: int, z: int) -> "Outline":
        """The outline with its coordinates times the signs ``y`` and ``z``."""
        return Outline(tuple(tuple((y * a, z * b) for a, b in loop) for loop in self.loops))

    def side_at(self, point: Corner) -> int:
        """Number of the side that holds ``point`` (m). Raises ValueError for a point on no side, or at
        a corner, where two sides meet."""
        sides = self.sides()
        away = [_distance(point, side) for side in sides]
        found = [number for number, distance in enumerate(away) if distance < SAME]
        if len(found) == 1:
            return found[0]
        nearest = min(range(len(away)), key=away.__getitem__)
        where = (
            "this is a corner"
            if found
            else f"the nearest side is {sides[nearest].words()}, {1e3 * away[nearest]:.4g} mm away"
        )
        raise ValueError(f"a point on one side of the section; {where}")


def outline(loops: Iterable[Sequence[Corner]]) -> Outline:
    """The outline with these ``loops`` in any order and direction; the largest is the outer border.

    Raises ValueError with the first fault: too many corners, a loop without area, a side that is too
    short, folds back or meets another one, loops that do not lie inside the outer one.
    """
    given = [tuple((float(y), float(z)) for y, z in loop) for loop in loops]
    if sum(map(len, given)) > MOST_CORNERS:
        raise ValueError(f"at most {MOST_CORNERS} corners, not {sum(map(len, given))}")
    for loop in given:
        if len(loop) < 3:
            raise ValueError(f"three corners or more, not {len(loop)}")
    given.sort(key=lambda loop: -abs(_area(loop)))
    turned = tuple(
        loop if (_area(loop) > 0.0) == (number == 0) else loop[::-1]
        for number, loop in enumerate(given)
    )
    found = Outline(turned)
    _require_sides(found)
    for number, hole in enumerate(turned[1:], start=1):
        if not _is_inside(hole[0], turned[0]) or any(
            _is_inside(hole[0], other) for other in turned[1:number]
        ):
            raise ValueError(
                f"one outer border with holes inside it, none within another; the loop through "
                f"({1e3 * hole[0][0]:.6g}, {1e3 * hole[0][1]:.6g}) mm is none"
            )
    return found


def _area(loop: Loop) -> float:
    return 0.5 * sum(a * d - c * b for (a, b), (c, d) in zip(loop, loop[1:] + loop[:1]))


def _distance(point: Corner, side: Side) -> float:
    start, end, place = (np.array(each) for each in (*side, point))
    along = end - start
    share = np.clip((place - start) @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(place - start - share * along))


def _is_inside(point: Corner, loop: Loop) -> bool:
    """Whether a ray from ``point`` along +Y meets ``loop`` an odd number of times."""
    odd = False
    for (a, b), (c, d) in zip(loop, loop[1:] + loop[:1]):
        if (b > point[1]) != (d > point[1]):
            odd ^= point[0] < a + (point[1] - b) * (c - a) / (d - b)
    return odd


def _require_sides(found: Outline) -> None:
    sides = found.sides()
    for side in sides:
        if math.dist(*side) < SHORTEST:
            raise ValueError(f"sides of {1e3 * SHORTEST:g} mm or more, not {side.words()}")
    ends = np.array([[side.start, side.end] for side in sides])
    follows = _followers(found)
    for first, side in enumerate(sides):
        other = ends[first + 1 :]
        meets = _meets(np.array(side), other)
        for second in np.flatnonzero(meets) + first + 1:
            joined = follows[first] == second or follows[second] == first
            if joined and not _folds_back(side, sides[second]):
                continue
            raise ValueError(
                f"sides that meet only at their ends, not {side.words()} and "
                f"{sides[second].words()}"
            )


def _followers(found: Outline) -> list[int]:
    """Number of the side after each one."""
    numbers, first = [], 0
    for loop in found.loops:
        numbers += [first + (place + 1) % len(loop) for place in range(len(loop))]
        first += len(loop)
    return numbers


def _folds_back(one: Side, two: Side) -> bool:
    """Whether two sides that share a corner lie upon each other."""
    (a, b), (c, d) = one.normal, two.normal
    return abs(a * d - b * c) < 1e-12 and a * c + b * d < 0.0


def _meets(side: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Which of the ``other`` sides (n,2,2) meet ``side`` (2,2), also in one point."""
    low, high = side.min(axis=0), side.max(axis=0)
    near = ((other.min(axis=1) <= high) & (other.max(axis=1) >= low)).all(axis=1)
    return near & (_across(side, other) <= 0.0) & (_across_each(other, side) <= 0.0)


def _turn(start: np.ndarray, end: np.ndarray, point: np.ndarray) -> np.ndarray:
    along, there = end - start, point - start
    return np.sign(along[..., 0] * there[..., 1] - along[..., 1] * there[..., 0])


def _across(side: np.ndarray, other: np.ndarray) -> np.ndarray:
    return _turn(side[0], side[1], other[:, 0]) * _turn(side[0], side[1], other[:, 1])


def _across_each(other: np.ndarray, side: np.ndarray) -> np.ndarray:
    return _turn(other[:, 0], other[:, 1], side[0]) * _turn(other[:, 0], other[:, 1], side[1])
