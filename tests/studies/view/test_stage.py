"""A run to look at: VTK files that hold what the run had, the list of them, pictures where there is
pyvista, and the page."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from tests.highfi.support import begun, stopped, tiny
from tests.studies import kept
from tests.studies.shown import Documents, html
from tipoff import scenes
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics import monitor
from tipoff.highfi.stress.peak import STRESS, no_peak
from tipoff.results.trajectory import Trajectory
from tipoff.studies.cli import app
from tipoff.studies.report.page import Page
from tipoff.studies.runs import stage as runs
from tipoff.studies.runs import stress_page as section
from tipoff.studies.runs.figures import Runs
from tipoff.studies.view import frames, vtk_files
from tipoff.studies.view import stage as view
from tipoff.studies.view.options import ViewOptions
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

TOUCHING = 115  # a sample at which pads of ``tiny`` touch


@pytest.fixture(scope="module")
def viewed(tmp_path_factory):
    """(study, result) of the stage on ``tiny``, as if pyvista were not there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(view, "pyvista_version", lambda: None)
        study = Study(
            scenes.load("tiny"), tmp_path_factory.mktemp("out") / "tiny", defaults("tiny")
        )
        yield study, view.run(study, ViewOptions("phi15", 7))


@pytest.fixture(scope="module")
def touching():
    """A loop at a moment when pads touch, and its frame."""
    loop = stopped(TOUCHING)
    return loop, frames.Camera(loop).take(loop)


def test_without_pyvista_there_are_files_and_a_way_to_pictures(viewed):
    study, made = viewed
    found = made.document
    assert found["pictures"] == {} and "pip install pyvista" in found["without_pictures"]
    assert len(found["frames"]) == 7 and len(found["files"]) == 2 * 7 + 2  # run.pvd, table
    assert view.run(study, ViewOptions("phi15", 7)) == made  # nothing changed, nothing made
    assert view.stored(study) == [made.result]


def test_the_list_names_every_file_at_its_time(viewed):
    study, made = viewed
    found = made.document
    listed = ElementTree.parse(study.path(found["collection"])).getroot()
    assert (listed.tag, listed.get("type")) == ("VTKFile", "Collection")
    sets = listed.findall("./Collection/DataSet")
    expected = [
        (frame["time_s"], part, frame[name])
        for frame in found["frames"]
        for part, name in enumerate(("rails", "bodies"))
    ]
    assert [
        (float(item.get("timestep")), int(item.get("part")), item.get("file")) for item in sets
    ] == [(pytest.approx(time), part, file) for time, part, file in expected]
    assert all((study.path(found["folder"]) / file).is_file() for _, _, file in expected)


def test_one_frame_is_the_moment_of_the_peak_and_shows_it(viewed):
    study, made = viewed
    found = made.document
    run = Trajectory.load(study.store.path(study.highfi("phi15")))
    frame = found["frames"][found["peak"]["frame"]]
    assert frame["time_s"] == pytest.approx(run.stress["peak_stress_time_s"])
    rails = meshio.read(study.path(found["folder"]) / frame["rails"])
    worst = rails.cell_data[vtk_files.WORST][0]
    assert worst.max() == pytest.approx(run.stress["peak_stress_pa"], rel=1e-6)
    corners = rails.points[rails.cells_dict["hexahedron"][worst.argmax()]]
    # Elements beside each other may tie, so the place is a corner of the worst or its like.
    assert np.linalg.norm(corners - run.stress["peak_stress_place_m"], axis=1).min() < 0.02
    assert rails.point_data[vtk_files.VON_MISES].max() <= worst.max() * (1.0 + 1e-6)


def test_files_hold_what_the_loop_had(touching, tmp_path):
    loop, frame = touching
    boxes, pads = frames.bodies(loop.setup.scene, loop.setup.system.model)
    paths = vtk_files.write_frame(tmp_path, 3, frame, loop.setup.system.mesh, boxes, pads)
    rails, bodies = (meshio.read(path) for path in paths)
    assert [path.name for path in paths] == ["rails-0003.vtu", "bodies-0003.vtu"]
    np.testing.assert_allclose(
        rails.point_data[vtk_files.DISPLACEMENT],
        loop.stepper.state.displacement[loop.setup.system.number],
        rtol=1e-6,
        atol=1e-15,
    )
    np.testing.assert_array_equal(rails.points, loop.setup.system.mesh.points)
    assert len(bodies.cells_dict["hexahedron"]) == 1 + 16
    assert np.bincount(bodies.cell_data[vtk_files.PAD][0]).tolist() == [1] + [2] * 8
    # Payload and pads moved out of the rails, as far as the payload did.
    middle = bodies.points[:8].mean(axis=0)
    way = (
        loop.stepper.state.payload.position
        - loop.stepper.state.platform.position
        + loop.setup.system.origin
    )
    assert middle == pytest.approx(way, abs=1e-4)


@pytest.mark.parametrize("size, off", [(0.004, 0.2), (0.002, 0.05)])
def test_contact_pressure_comes_to_the_force_on_the_pads(size, off):
    """Pressure at nodes times their share of the wall, as the nodes under a pad grow in number."""
    numerics = Numerics(element_size=size)
    loop = begun(tiny(), numerics)
    # Pressed 30 um into one wall, long before the payload would get there: faces that wait must
    # look.
    loop.stepper.active.wait[:] = 0
    loop.stepper.state.payload.position[1] += loop.setup.scene.contact.clearance + 30e-6
    loop.stepper.evaluate()
    mesh, frame = loop.setup.system.mesh, frames.Camera(loop).take(loop)
    share = np.zeros(len(mesh.points))
    for name, facets in mesh.surfaces.items():
        if name.startswith("contact"):
            corners = mesh.points[facets]
            areas = 0.5 * np.linalg.norm(
                np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1
            )
            np.add.at(share, facets, 0.25 * areas[:, None])
    normal = np.abs(
        loop.stepper.state.face_force[np.arange(16), loop.setup.system.faces.axis]
    ).sum()
    assert normal > 1000.0
    assert (frame.pressure * share).sum() == pytest.approx(normal, rel=off)
    assert not frame.pressure[share == 0.0].any()


def test_camera_sees_the_stress_that_the_run_is_watched_for(touching):
    loop, frame = touching
    worst = no_peak()
    monitor.scan(loop.setup.monitor, loop.stepper.state.displacement, 0.0, worst, loop.setup.pool)
    assert frame.worst.max() == pytest.approx(
        loop.setup.monitor.shear_modulus * np.sqrt(worst.square[STRESS]), rel=1e-12
    )
    assert frame.worst.argmax() == worst.place[STRESS, 0]
    still = frames.Camera(first := begun()).take(first)
    assert not still.displacement.any() and not still.worst.any() and not still.pressure.any()


def test_fewer_frames_leave_no_old_ones(tmp_path):
    for index in range(3):
        (tmp_path / f"rails-{index:04d}.vtu").write_text("")
    vtk_files.discard_others(tmp_path, [tmp_path / "rails-0000.vtu"])
    assert [path.name for path in tmp_path.iterdir()] == ["rails-0000.vtu"]


@pytest.mark.parametrize("largest, factor", [(1e-5, 500.0), (3e-5, 200.0), (0.02, 1.0), (0.0, 1.0)])
def test_exaggeration_is_a_round_number_that_shows_the_deformation(largest, factor):
    assert view.exaggeration([SimpleNamespace(largest_displacement_m=largest)]) == factor


@pytest.mark.parametrize("value, end", [(12.9e6, 15e6), (1.0, 1.0), (0.0, 1.0), (9.1, 10.0)])
def test_scales_end_at_round_numbers(value, end):
    assert view.rounded_up(value) == pytest.approx(end)


def test_command_writes_and_prints(viewed, monkeypatch):
    study, made = viewed
    found = made.document
    monkeypatch.setattr(view, "pyvista_version", lambda: None)
    arguments = [
        "view",
        "--scene",
        "tiny",
        "--condition",
        "phi15",
        "--frames",
        "7",
        "--out",
        str(study.folder.parent),
    ]
    told = CliRunner().invoke(app, [*arguments, "--json"], catch_exceptions=False)
    assert told.exit_code == 0 and json.loads(told.stdout) == found
    said = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert said.stdout.splitlines()[-1].startswith(f"  {study.folder / found['folder']}/ (")
    assert found["collection"] in said.stdout
    assert f"{1e-6 * found['peak']['stress_pa']:.4g} MPa" in said.stdout


def known(**parts):
    """The run of the condition phi15 of ``tiny``."""
    return replace(kept.result(runs.STAGES["highfi"]).conditions[0], **parts)


def test_page_says_what_would_show_more(viewed):
    study, made = viewed
    found = made.document
    page = Page(
        study.scene,
        study.folder,
        Documents(highfi={"key": "k", "conditions": [asdict(known())], "failed": []}),
        Runs({}, {}, {}),
        {},
    )
    shown = html(section.draw(page))
    assert "tipoff view --scene tiny --out" in shown and "notice" not in shown
    page.results["view"] = view.stored(study)
    shown = html(section.draw(page))
    assert (
        "tipoff view" not in shown
        and "pip install pyvista" in shown
        and found["collection"] in shown
    )
    without = Page(study.scene, study.folder, {}, Runs({}, {}, {}), {})
    assert "tipoff run --all --model finite-elements --scene tiny --out" in html(
        section.draw(without)
    )


def test_page_warns_and_escapes():
    warned = html(section.shown([known(warnings=["stress <above> yield"])], [], Path("."), "tiny"))
    assert 'class="notice"' in warned and "stress &lt;above&gt; yield" in warned
    without = section.shown([replace(known(), peak_stress_pa=None)], [], Path("."), "tiny")
    assert without == ["No run of the reference contains peak stresses."]


def test_pictures_are_drawn_and_embedded(viewed, monkeypatch):
    pytest.importorskip("pyvista")
    from PIL import Image

    monkeypatch.setattr(view, "pyvista_version", lambda: "there")
    study, made = viewed
    found = made.document
    folder = study.path(found["folder"])
    result = made.result
    short = replace(result, frames=result.frames[:4], peak=replace(result.peak, frame=3))
    drawn, why = view.draw_pictures(short, folder)
    names = ["peak.png", "ejection.webp", "peak-dark.png", "ejection-dark.webp"]
    assert (drawn, why) == (names, "")
    for still, moving, paper in ([*names[:2], (255, 255, 255)], [*names[2:], (19, 24, 30)]):
        with Image.open(folder / still) as picture, Image.open(folder / moving) as film:
            colours = picture.convert("RGB").getcolors(1 << 24)
            assert picture.width > 1000 and len(colours) > 100 and max(colours)[1] == paper
            assert film.n_frames >= 2
        assert (folder / moving).stat().st_size < 1_500_000
    pictures = {name.partition(".")[0]: f"{found['folder']}/{name}" for name in names}
    views = [replace(result, pictures=pictures)]
    shown = html(section.shown([known()], views, study.folder, "tiny"))
    assert shown.count("data:image/") == 4 and shown.count("<picture>") == 2
    assert "times their deformation" in shown
