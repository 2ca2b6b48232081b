"""Closed loops of straight lines and arcs, as a drawing or a solid has them, and their corners.

The bulge of a point is the tangent of a quarter of the angle of the arc to the next one; it is positive
if the arc turns to the left. Arcs become chords that deviate by at most ``DEVIATION`` of the larger
extent.
"""

import math

from tipoff.formats.outline import Corner

DEVIATION = 0.0025  # of the larger extent
_JOINED = 1e-4  # of the larger extent: ends closer than this are one
_STRAIGHT = 1e-9  # of the larger extent: an arc this close to its chord is a line
LARGEST = 1e3  # m, of a coordinate
_MOST_BULGE = 1e4  # the chord of such an arc is 1e-4 of its circle

# the points of a line, an arc or several: (y, z, bulge to the next one) in units of the file
Polyline = list[tuple[float, float, float]]


def closed_loops(
    open_paths: list[Polyline], closed: list[Polyline], scale: float
) -> list[list[Corner]]:
    """Corners (m) of each loop: of ``closed`` ones, and of those that ``open_paths`` make in any order and
    direction; ``scale`` (m) of their unit. Raises ValueError if they make no closed loops."""
    every = [point[:2] for each in (*open_paths, *closed) for point in each]
    if (most := scale * max(abs(place) for point in every for place in point)) > LARGEST:
        raise ValueError(f"places within {LARGEST:g} m of the origin, not {most:.4g} m away")
    extent = max(max(axis) - min(axis) for axis in zip(*every))
    found = closed + _chained(open_paths, _JOINED * extent)
    return [[(scale * y, scale * z) for y, z in _corners(each, extent)] for each in found]


def _chained(paths: list[Polyline], near: float) -> list[Polyline]:
    """Closed loops of open paths, whose ends are at most ``near`` apart."""
    left, found = list(paths), []
    while left:
        chain = left.pop(0)
        while math.dist(chain[0][:2], chain[-1][:2]) > near or len(chain) < 3:
            end = chain[-1][:2]
            place = next((n for n, path in enumerate(left) if _touches(path, end, near)), None)
            if place is None:
                raise ValueError(
                    f"closed loops; one ends at ({end[0]:.6g}, {end[1]:.6g}) of the drawing"
                )
            path = left.pop(place)
            if math.dist(path[0][:2], end) > near:
                path = _reversed(path)
            chain = [*chain[:-1], (*end, path[0][2]), *path[1:]]
        found.append(chain[:-1])
    return found


def _touches(path: Polyline, end: Corner, near: float) -> bool:
    return any(math.dist(path[place][:2], end) <= near for place in (0, -1))


def _reversed(path: Polyline) -> Polyline:
    bulges = [-bulge for _, _, bulge in path[-2::-1]] + [0.0]
    return [(y, z, bulge) for (y, z, _), bulge in zip(path[::-1], bulges)]


def _corners(path: Polyline, extent: float) -> list[Corner]:
    """Corners of a closed path of a drawing of this ``extent``, whose arcs are chords."""
    found: list[Corner] = []
    for (y, z, bulge), (to_y, to_z, _) in zip(path, path[1:] + path[:1]):
        found.append((y, z))
        half_y, half_z = 0.5 * (to_y - y), 0.5 * (to_z - z)
        if abs(bulge) > _MOST_BULGE:
            raise ValueError(f"arcs with an angle below 360 degrees; one at ({y:.6g}, {z:.6g})")
        if abs(bulge) * math.hypot(half_y, half_z) <= _STRAIGHT * extent:
            continue
        sweep = 4.0 * math.atan(bulge)
        to_centre = (1.0 - bulge * bulge) / (2.0 * bulge)  # of half of the chord, to its left
        centre = (y + half_y - half_z * to_centre, z + half_z + half_y * to_centre)
        radius, begin = math.dist(centre, (y, z)), math.atan2(z - centre[1], y - centre[0])
        step = 2.0 * math.acos(max(0.0, 1.0 - DEVIATION * extent / radius))
        count = max(2, math.ceil(abs(sweep) / step - 1e-9))
        for part in range(1, count):
            angle = begin + sweep * part / count
            found.append(
                (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
            )
    return found
