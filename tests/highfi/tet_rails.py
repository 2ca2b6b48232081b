"""The built-in L rails as gmsh fills them with ten-node tetrahedra, mirrored like the built-in
ones."""

import itertools

import numpy as np

from tipoff.meshes import generator, msh

_CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))
# nodes of a tetrahedron, and below of a triangle, whose orientation is reversed
_MIRROR_CELL = [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]
_MIRROR_FACET = [0, 2, 1, 5, 4, 3]
_TOUCH = 1e-6  # m


def build(g, size):
    """Meshio mesh of the rails of an `LRailGeometry`, edges about `size` (m)."""
    with generator.session("tetrahedra") as gmsh:
        _draw(gmsh, g)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.optimize("Netgen")
        gmsh.model.mesh.setOrder(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        number[tags.astype(np.int64)] = np.arange(len(tags))
        points = places.reshape(-1, 3)
        cells = number[gmsh.model.mesh.getElementsByType(11)[1].astype(np.int64)].reshape(-1, 10)[
            :, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
        ]
        surfaces = {
            name: np.concatenate(
                [
                    number[gmsh.model.mesh.getElementsByType(9, tag)[1].astype(np.int64)].reshape(
                        -1, 6
                    )
                    for tag in _inside(gmsh, boxes)
                ]
            )
            for name, boxes in _boxes(g).items()
        }
    return _mirrored(points, cells, surfaces)


def _draw(gmsh, g):
    """The rail of the (+,+) corner, the borders of its mounts drawn onto it by blocks that touch it
    there."""
    occ, length = gmsh.model.occ, g.x_end - g.x_start
    y, z = g.inner_corner_y + g.thickness, g.inner_corner_z + g.thickness
    legs = [
        (3, occ.addBox(g.x_start, y - g.leg, z - g.thickness, length, g.leg, g.thickness)),
        (3, occ.addBox(g.x_start, y - g.thickness, z - g.leg, length, g.thickness, g.leg)),
    ]
    rail, _ = occ.fuse(legs[:1], legs[1:])
    occ.synchronize()
    blocks = []
    for start, end in g.mount_spans:
        blocks.append(
            (
                3,
                occ.addBox(
                    g.x_start + start, y, z - g.mount_width, end - start, 0.01, g.mount_width
                ),
            )
        )
        blocks.append(
            (
                3,
                occ.addBox(
                    g.x_start + start, y - g.mount_width, z, end - start, g.mount_width, 0.01
                ),
            )
        )
    _, made = occ.fragment(rail, blocks)
    kept = set(made[0])
    occ.remove(
        [entity for part in made[1:] for entity in part if entity not in kept], recursive=True
    )
    occ.synchronize()


def _boxes(g):
    """Flat boxes (low, high) that the named surfaces fill."""
    y, z = g.inner_corner_y + g.thickness, g.inner_corner_z + g.thickness
    mounts = itertools.chain.from_iterable(
        (
            ((g.x_start + a, y, z - g.mount_width), (g.x_start + b, y, z)),
            ((g.x_start + a, y - g.mount_width, z), (g.x_start + b, y, z)),
        )
        for a, b in g.mount_spans
    )
    return {
        "contact_y": [
            (
                (g.x_start, g.inner_corner_y, z - g.leg),
                (g.x_end, g.inner_corner_y, g.inner_corner_z),
            )
        ],
        "contact_z": [
            (
                (g.x_start, y - g.leg, g.inner_corner_z),
                (g.x_end, g.inner_corner_y, g.inner_corner_z),
            )
        ],
        "mount": list(mounts),
    }


def _inside(gmsh, boxes):
    return [
        tag
        for low, high in boxes
        for _, tag in gmsh.model.getEntitiesInBoundingBox(
            *(value - _TOUCH for value in low), *(value + _TOUCH for value in high), dim=2
        )
    ]


def _mirrored(points, cells, surfaces):
    parts = []
    for rail, (y, z) in enumerate(_CORNERS):
        turned, shift = y * z < 0, rail * len(points)
        parts.append(
            (
                points * (1, y, z),
                (cells[:, _MIRROR_CELL] if turned else cells) + shift,
                {
                    name: (facets[:, _MIRROR_FACET] if turned else facets) + shift
                    for name, facets in surfaces.items()
                },
            )
        )
    return msh.tagged(
        np.concatenate([part[0] for part in parts]),
        np.concatenate([part[1] for part in parts]),
        {name: np.concatenate([part[2][name] for part in parts]) for name in surfaces},
    )
