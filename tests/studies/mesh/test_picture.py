"""The section of a rail that the picture of its mesh shows."""

import numpy as np
import pytest

from tipoff import highfi, scenes
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.pieces import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.studies.mesh import picture


def area(polygon: np.ndarray) -> float:
    y, z = polygon.T
    return 0.5 * abs(np.dot(y, np.roll(z, 1)) - np.dot(z, np.roll(y, 1)))


@pytest.mark.parametrize("name, rails", [("tiny", 4), ("rocket_rail", 1)])
def test_the_section_has_the_area_and_the_surfaces_of_the_rail(name, rails):
    """The webs of a T-slot are oblique. Control: the boxes around its elements, which are larger."""
    mesh = highfi.prepare(scenes.load(name), highfi.Numerics(element_size=20e-3))
    volume = hexahedron.basis(mesh.points[mesh.cells]).dx.sum() / rails
    length = np.ptp(mesh.points[:, 0])
    polygons, lines = picture.section(mesh)
    assert len(pieces(mesh)) == rails
    assert sum(map(area, polygons)) == pytest.approx(1e6 * volume / length, rel=1e-9)
    boxes = sum(np.ptp(polygon, axis=0).prod() for polygon in polygons)
    assert (boxes > 1.1e6 * volume / length) == (name == "rocket_rail")
    assert set(lines) == set(mesh.surfaces)
    colours = picture.colours_of(mesh)  # the four walls of a slot had three colours
    assert set(colours) == set(mesh.surfaces) and len(set(colours.values())) == len(colours)
    walls = [name for name, found in lines.items() if found]
    assert {"contact_y", "contact_z"} <= set(walls) if name == "tiny" else len(walls) >= 6


def test_edges_are_cut_where_the_plane_passes():
    """An element from a square of 2 m to one of 4 m, three of whose corners are 1 m away and one 4 m: the
    plane is 0.875 m away, in the mean of all corners."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    near = np.column_stack([np.zeros(4), square])
    far = np.column_stack([[1.0, 1.0, 1.0, 4.0], 2.0 * square])
    mesh = RailMesh(np.vstack([near, far]), np.arange(8)[None], {})
    (polygon,), _ = picture.section(mesh)
    expected = 1e3 * square * [[1.875], [1.875], [1.875], [1.0 + 0.875 / 4.0]]
    np.testing.assert_allclose(polygon[np.lexsort(polygon.T)], expected[np.lexsort(expected.T)])
