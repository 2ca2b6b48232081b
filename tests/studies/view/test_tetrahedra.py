"""A run on ten-node tetrahedra to look at: files of quadratic elements with the stress the plain
formulas find, and pictures."""

import meshio
import numpy as np
import pytest
from PIL import Image

from tests.highfi.elements.test_tetrahedral_recovery import at_nodes
from tests.highfi.rail.test_tetrahedral_rail import cut
from tests.highfi.stress.test_tetrahedral_peaks import THROWN
from tests.highfi.support import stopped, tiny
from tipoff.highfi.elements import hexahedral_recovery, hexahedron
from tipoff.studies.view import frames, pictures, vtk_files

LAW = hexahedron.elasticity(72e9, 0.33)


@pytest.fixture(scope="module")
def touching(tmp_path_factory):
    """A loop on tetrahedra at a moment when pads press, its frame, and the file of its rails."""
    folder = tmp_path_factory.mktemp("view")
    loop = stopped(6, cut(tiny(**THROWN), 0.008, folder / "rails.msh"))
    frame = frames.Camera(loop).take(loop)
    vtk_files.write_frame(
        folder,
        0,
        frame,
        loop.setup.system.mesh,
        *frames.bodies(loop.setup.scene, loop.setup.system.model),
    )
    return loop, frame, folder


def test_files_hold_quadratic_tetrahedra_and_their_stress(touching):
    """Mean stress at a node over the elements that meet there, of its corners and of the middles of
    its edges alike."""
    loop, _, folder = touching
    mesh, rails = loop.setup.system.mesh, meshio.read(folder / "rails-0000.vtu")
    np.testing.assert_array_equal(rails.cells_dict["tetra10"], mesh.cells)
    np.testing.assert_array_equal(rails.points, mesh.points)
    moved = loop.stepper.state.displacement[loop.setup.system.number]
    np.testing.assert_allclose(
        rails.point_data[vtk_files.DISPLACEMENT], moved, rtol=1e-6, atol=1e-15
    )
    stress, mean = at_nodes(mesh, LAW, moved), np.zeros((len(mesh.points), 6))
    np.add.at(mean, mesh.cells, stress)
    mean = hexahedral_recovery.von_mises(mean / np.bincount(mesh.cells.ravel())[:, None])
    assert mean.max() > 1e6
    np.testing.assert_allclose(
        rails.point_data[vtk_files.VON_MISES], mean, rtol=1e-6, atol=1e-6 * mean.max()
    )
    np.testing.assert_allclose(
        rails.cell_data[vtk_files.WORST][0],
        hexahedral_recovery.von_mises(stress).max(axis=1),
        rtol=1e-6,
    )


def test_contact_pressure_is_on_walls_that_are_pressed(touching):
    loop, frame, _ = touching
    surfaces = loop.setup.system.mesh.surfaces
    walls = np.unique(
        np.concatenate(
            [facets.ravel() for name, facets in surfaces.items() if name.startswith("contact")]
        )
    )
    pressed = np.flatnonzero(frame.pressure)
    assert pressed.size and np.isin(pressed, walls).all()
    assert np.isin(pressed, loop.setup.system.mesh.cells[:, 4:]).any()  # middles of edges too


@pytest.fixture
def order(touching):
    """What the pictures of that one frame are asked with, twice over."""
    loop, frame, folder = touching
    low, high = loop.setup.system.mesh.points.min(axis=0), loop.setup.system.mesh.points.max(axis=0)
    shown = {"rails": "rails-0000.vtu", "bodies": "bodies-0000.vtu", "time_s": frame.time}
    place = loop.setup.system.mesh.points[frame.von_mises.argmax()]
    return {
        "folder": str(folder),
        "frames": [shown, shown],
        "factor": 20.0,
        "bounds": [low.tolist(), high.tolist()],
        "peak": {
            "frame": 1,
            "place_m": place.tolist(),
            "stress_pa": float(frame.worst.max()),
            "rail": "all",
        },
        "title": "tiny / tetrahedra",
        "mesh": "elements of 8 mm",
        "scale_pa": float(frame.von_mises.max()),
    }


def test_pictures_show_each_node_its_own_stress(touching, order):
    pyvista = pytest.importorskip("pyvista")
    _, frame, folder = touching
    drawing = pictures.Drawing(order, (600, 400))
    drawing.show(1)
    moved = pyvista.read(folder / "rails-0000.vtu").points + 20.0 * frame.displacement
    apart = np.linalg.norm(moved - drawing.surface.points[:, None], axis=2)
    assert apart.min(axis=1).max() < 1e-6
    np.testing.assert_allclose(
        drawing.surface["stress"],
        1e-6 * frame.von_mises[apart.argmin(axis=1)],
        rtol=1e-5,
        atol=1e-6,
    )
    assert np.abs(drawing.net.points - moved).max() < 1e-6
    drawing.plotter.close()


def test_pictures_are_drawn(order):
    pytest.importorskip("pyvista")
    with Image.open(pictures.still(order)) as still:
        assert still.width > 1000 and len(still.convert("RGB").getcolors(1 << 24)) > 100
