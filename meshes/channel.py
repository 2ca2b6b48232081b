"""Two C channels with lightening holes as structured hexahedra: the rail file of the catalogue
scene `channel`.

Scene frame: SI, origin at the payload mass centre at t = 0, +X to the open end. One channel is at
each side, y > 0 and y < 0, open towards the payload: pads press its web along y and its flanges
along z. Between the mounts the web has holes. Each is a block of missing grid cells whose border
nodes are moved onto a circle, so that the mesh stays a grid of one layer with blunt corners.

    python -m meshes.channel scenes/catalog/channel.msh      writes the file of the catalogue, bit for bit
"""

import sys

import meshio
import numpy as np

from tipoff.meshes import msh

_START = -0.088  # m, rear end
_WEB, _FLANGE = 0.10025, 0.03025  # m, |y| and |z| of the inner walls
_THICKNESS, _REACH = 0.004, 0.022  # m, of all walls; of the flanges inwards from the web
_BAY, _RADIUS = 0.024, 0.007  # m, side of the square around a hole, radius of the hole
# Lengths (m) along X and cells of each: ends, three mounts, and three bays with a hole each between
# two mounts.
_END, _MOUNT, _BAYS = (0.008, 1), (0.020, 4), ((_BAY, 4),) * 3
_ALONG = (_END, _MOUNT, *_BAYS, _MOUNT, *_BAYS, _MOUNT, _END)
_STRIP = (_FLANGE - _BAY / 2, 3)  # of the web between a flange and the bays
_ACROSS = ((_THICKNESS, 1), _STRIP, (_BAY, 4), _STRIP, (_THICKNESS, 1))
_CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)
_MIRRORED = [3, 2, 1, 0, 7, 6, 5, 4]  # VTK corners of a brick whose y has changed sign


def build() -> meshio.Mesh:
    """Both channels. Surfaces: `contact_web` and `contact_flange`, inner walls beside the holes,
    and `mount`, the web outside."""
    points, hexes, surfaces = _channel()
    count = len(points)
    both = {name: np.concatenate([facets, facets + count]) for name, facets in surfaces.items()}
    return msh.tagged(
        np.concatenate([points, points * (1, -1, 1)]),
        np.concatenate([hexes, hexes[:, _MIRRORED] + count]),
        both,
    )


def _lines(start: float, pieces) -> tuple[np.ndarray, np.ndarray]:
    """Places (m) of the grid lines and, for each cell between two of them, the number of its
    piece."""
    ends = start + np.cumsum([0.0, *(length for length, _ in pieces)])
    lines = [
        np.linspace(left, right, cells + 1)[:-1]
        for left, right, (_, cells) in zip(ends, ends[1:], pieces)
    ]
    return np.append(np.concatenate(lines), ends[-1]), np.repeat(
        np.arange(len(pieces)), [cells for _, cells in pieces]
    )


def _channel():
    """Points (n,3), hexes (e,8) and facets of the channel at y > 0: the metal cells of one grid."""
    x, along = _lines(_START, _ALONG)
    y, inwards = _lines(_WEB - _REACH, ((_REACH, 4), (_THICKNESS, 1)))
    z, across = _lines(-_FLANGE - _THICKNESS, _ACROSS)
    piece = np.stack(np.meshgrid(along, inwards, across, indexing="ij"), axis=-1).reshape(-1, 3)
    cell = np.stack(
        np.meshgrid(*(np.arange(len(line) - 1) for line in (x, y, z)), indexing="ij"), axis=-1
    ).reshape(-1, 3)
    web, flange = piece[:, 1] == 1, np.isin(piece[:, 2], (0, 4))
    bay = np.array([pieces is _BAYS[0] for pieces in _ALONG])
    mount = np.array([pieces is _MOUNT for pieces in _ALONG])
    in_bay = bay[piece[:, 0]] & (piece[:, 2] == 2)
    hole = in_bay & _inner(x, along, cell[:, 0]) & _inner(z, across, cell[:, 2])
    strip = np.isin(piece[:, 2], (1, 3))

    shape = (len(x), len(y), len(z))
    nodes = np.ravel_multi_index(np.moveaxis(cell[:, None] + _CUBE, -1, 0), shape)
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    rim = np.intersect1d(nodes[hole], nodes[web & in_bay & ~hole])
    points[rim] = _on_circle(points[rim], x[:-1][np.r_[True, np.diff(along) > 0]], bay)
    surfaces = {
        "contact_web": nodes[web & strip][:, [0, 1, 5, 4]],
        "contact_flange": np.concatenate(
            [
                nodes[flange & ~web & (piece[:, 2] == 0)][:, [4, 5, 6, 7]],
                nodes[flange & ~web & (piece[:, 2] == 4)][:, [0, 3, 2, 1]],
            ]
        ),
        "mount": nodes[web & strip & mount[piece[:, 0]]][:, [3, 7, 6, 2]],
    }
    hexes = nodes[(web | flange) & ~(web & hole)]
    used, number = np.unique(hexes, return_inverse=True)
    return (
        points[used],
        number.reshape(-1, 8),
        {name: np.searchsorted(used, facets) for name, facets in surfaces.items()},
    )


def _inner(lines, piece, cell) -> np.ndarray:
    """Whether a cell is not at an end of its piece."""
    return (piece[cell] == piece[np.maximum(cell - 1, 0)]) & (
        piece[cell] == piece[np.minimum(cell + 1, len(piece) - 1)]
    )


def _on_circle(points, starts, bay) -> np.ndarray:
    """Points at the border of a hole, moved away from the hole's axis onto its wall."""
    centres = starts[bay] + _BAY / 2
    centre = centres[np.argmin(np.abs(points[:, :1] - centres), axis=1)]
    arm = points[:, [0, 2]] - np.stack([centre, np.zeros_like(centre)], axis=1)
    arm *= _RADIUS / np.linalg.norm(arm, axis=1, keepdims=True)
    return np.stack([centre + arm[:, 0], points[:, 1], arm[:, 1]], axis=1)


if __name__ == "__main__":
    msh.save(build(), sys.argv[1])
