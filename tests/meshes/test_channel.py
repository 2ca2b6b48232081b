"""The channels of the catalogue: the committed file is what the script makes, and it is the solid
that its docstring describes."""

import math

import numpy as np
import pytest

from tests.highfi.mesh.test_rail_mesh import facet_vectors
from tipoff.highfi.mesh.cells import corner_jacobians
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.meshes import channel, msh
from tipoff.scenes import load


@pytest.fixture(scope="module")
def mesh():
    return read(channel.build())


def test_the_file_of_the_catalogue_is_what_the_script_makes(tmp_path):
    msh.save(channel.build(), tmp_path / "channel.msh")
    committed = load("channel").rail.path().read_bytes()
    assert committed == (tmp_path / "channel.msh").read_bytes()
    assert len(committed) < 300_000


def test_volume_and_walls(mesh):
    """Section 60.5 x 4 of the web and two flanges of 26 x 4 mm, twelve octagonal holes of 7 mm in
    all."""
    hole = 8 * 0.5 * 0.007**2 * math.sin(math.pi / 4)
    volume = 2 * (0.220 * 0.004 * (0.0605 + 2 * 0.026) - 6 * hole * 0.004)
    jacobian, scaled = corner_jacobians(mesh.points, mesh.cells)
    assert jacobian.mean(axis=1).sum() == pytest.approx(volume, rel=1e-6)
    assert scaled.min() > 0.9 and mesh.warnings == ()
    areas = {
        "contact_web": 4 * 0.220 * 0.01825,
        "contact_flange": 4 * 0.220 * 0.022,
        "mount": 4 * 3 * 0.020 * 0.01825,
    }
    for name, area in areas.items():
        vectors, centres = facet_vectors(mesh, name)
        assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(area, rel=1e-9)
        axis = 2 if name == "contact_flange" else 1
        outward = vectors[:, axis] * centres[:, axis]
        assert (outward > 0.0).all() if name == "mount" else (outward < 0.0).all()


def test_channels_are_mirror_images_to_the_last_bit(mesh):
    right, left = np.split(mesh.points, 2)
    assert np.array_equal(right * (1, -1, 1), left)
