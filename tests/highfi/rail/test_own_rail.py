"""Rails given as a file: the reference and the surrogate run them, and a file that contradicts its
scene is refused."""

import meshio
import numpy as np
import pytest

import tipoff
from tests.highfi.support import COARSE, tiny
from tests.meshes.test_solid import drawn, l_sections, l_surfaces, scene_of
from tipoff import highfi
from tipoff.highfi.mesh.rail_mesh import MeshError
from tipoff.highfi.rail.geometry import geometry
from tipoff.meshes import channel, l_rail, msh
from tipoff.scenes import SceneError, load

# The catalogue's channel under the fast pulse of the tiny scene, and aimed so badly that pads press
# within its first 8 ms.
FAST = {
    "thrust_offset.misalignment.axial": "1 deg",
    "thrust.peak": "24 kN",
    "thrust.width": "1.5 ms",
    "thrust.centre": "4.5 ms",
    "output.interval": "0.1 ms",
}


def channels(**overrides):
    changes = FAST | {key.replace("__", "."): value for key, value in overrides.items()}
    return load("channel").condition("phi15").replace(changes)


def from_file(scene, path):
    """``scene`` with its rail given by a file."""
    start, end, material = scene.rail.start, scene.rail.end, scene.rail.material.model_dump()
    return scene.replace(
        {"rail": {"mesh": str(path), "start": start, "end": end, "material": material}}
    )


def saved(mesh: meshio.Mesh, path):
    msh.save(mesh, path)
    return path


def assert_promises(found):
    assert found.checks["energy_error"] <= 1e-5
    assert found.checks["transverse_energy_error"] <= 1e-3
    assert found.checks["linear_momentum_error"] <= 1e-12
    assert found.checks["angular_momentum_error"] <= 1e-8
    assert found.checks["quaternion_error"] <= 1e-12
    assert found.checks["friction_power_max"] <= 0.0


@pytest.mark.parametrize("duration", ["6.5 ms", pytest.param("12 ms", marks=pytest.mark.slow)])
def test_promises_hold_on_a_rail_that_is_no_extrusion(duration):
    """Through the first contact, and through several."""
    found = highfi.run(channels(duration=duration))
    assert np.abs(found.pad_force).max() > 100.0
    assert_promises(found)
    assert found.cost["dt_s"] <= found.cost["dt_limit_s"] * found.cost["safety"]


@pytest.mark.slow
def test_both_fidelities_leave_the_channels():
    reference, surrogate = (
        highfi.run(channels(duration="30 ms")),
        tipoff.run(channels(duration="30 ms"), "springs"),
    )
    assert reference.status == surrogate.status == "exited"
    assert_promises(reference)
    # Both follow from the thrust; they differ by the friction of impacts, which are harder on a
    # rigid wall.
    assert surrogate.outcome.exit_time == pytest.approx(reference.outcome.exit_time, rel=1e-2)
    assert surrogate.outcome.velocity[0] == pytest.approx(reference.outcome.velocity[0], rel=1e-2)


def test_the_surrogate_runs_it_too():
    found = tipoff.run(channels(duration="30 ms"), "springs")
    assert found.status == "exited"
    assert found.checks["energy_error"] <= 1e-5 and found.checks["linear_momentum_error"] <= 1e-12


@pytest.fixture(scope="module")
def wide(tmp_path_factory):
    """A scene on built-in rails, its run, and the same rails in a file."""
    scene = tiny(
        duration="8 ms", thrust_offset__misalignment__axial="1 deg", contact__clearance="0.25 mm"
    )
    path = tmp_path_factory.mktemp("wide") / "rails.msh"
    file = saved(l_rail.build(geometry(scene), COARSE.element_size), path)
    return scene, highfi.run(scene, COARSE), from_file(scene, file)


def test_the_built_in_rails_from_a_file_give_the_same_run(wide):
    """Up to rounding: elements of a file are numbered again, so sums are added in another order."""
    _, first, file = wide
    second = highfi.run(file, COARSE)
    assert np.abs(first.pad_force).max() > 100.0
    assert np.abs(second.rate - first.rate).max() <= 1e-9 * np.abs(first.rate).max()
    assert np.abs(second.velocity - first.velocity).max() <= 1e-12 * np.abs(first.velocity).max()


def test_a_smaller_element_size_splits_the_elements_of_the_file():
    coarse, fine = (
        highfi.prepare(channels(), highfi.Numerics(element_size=size)) for size in (0.004, 0.002)
    )
    assert len(fine.cells) == 8 * len(coarse.cells)


def test_walls_that_the_scene_places_elsewhere_are_all_named():
    with pytest.raises(SceneError) as caught:
        highfi.prepare(channels(rail__start="-90 mm", rail__end="140 mm", rail__clearance="0.3 mm"))
    faults = {fault.key: fault.expected for fault in caught.value.faults}
    assert set(faults) == {"rail.start", "rail.end", "rail.clearance"}
    assert "-0.088 m" in faults["rail.start"] and "0.00025 m" in faults["rail.clearance"]


def test_another_clearance_moves_the_pads(wide):
    """Moving the pads out by 0.05 mm has the effect of moving the walls in. Control: without it the
    difference would be twenty times larger."""
    scene, before, file = wide
    narrow = {"contact.clearance": "0.2 mm"}
    drawn_wide = file.replace({"rail.clearance": "0.25 mm"})
    wall, shim = (highfi.run(each.replace(narrow), COARSE).rate for each in (scene, drawn_wide))
    assert np.abs(shim - wall).max() < 0.05 * np.abs(before.rate - wall).max()


def test_a_pad_over_no_wall_is_named():
    pads = [pad.model_dump() for pad in channels().pads]
    pads[3]["position"] = (-0.08, 0.1, 0.05)
    with pytest.raises(SceneError) as caught:
        highfi.prepare(channels(pads=pads))
    assert [fault.key for fault in caught.value.faults] == ["pads.3", "pads.3"]
    given = [fault.given for fault in caught.value.faults]
    assert given == [f"a face {normal} with no wall under its track" for normal in ("+y", "+z")]


@pytest.mark.parametrize(
    "factor, axes, words",
    [
        (1e3, [0, 1, 2], ["in millimetres"]),
        (1.0 / 0.0254, [0, 1, 2], ["in inches"]),
        (1.0, [2, 0, 1], ["walls along y"]),
        (1e3, [1, 2, 0], ["in millimetres", "walls along z"]),
    ],
)
def test_another_unit_or_axis_is_named_before_memory_is_taken(tmp_path, factor, axes, words):
    """Split to the element size, a mesh in millimetres would have 1e9 times as many elements."""
    mesh = channel.build()
    mesh.points = factor * mesh.points[:, axes]
    scene = from_file(channels(), saved(mesh, tmp_path / "rails.msh"))
    with pytest.raises(SceneError) as caught:
        highfi.prepare(scene)
    assert [fault.key for fault in caught.value.faults] == ["rail.mesh"] * len(words)
    for fault, word in zip(caught.value.faults, words):
        assert word in f"{fault.given} {fault.expected}"


@pytest.mark.parametrize("model", ["reference", "compliance"])
def test_a_solid_that_nothing_holds_is_named(tmp_path, model):
    """The mount facets of y < 0 are missing. Control: with all of them the file is used."""
    mesh = channel.build()
    mount, physical = mesh.field_data["mount"][0], mesh.cell_data["gmsh:physical"]
    for block, tags in zip(mesh.cells, physical):
        if block.type == "quad":
            tags[(tags == mount) & (mesh.points[block.data][:, :, 1].mean(axis=1) < 0.0)] = 0
    scene = from_file(channels(), saved(mesh, tmp_path / "rails.msh"))
    with pytest.raises(MeshError, match=r"without a facet of 'mount'.* y -") as caught:
        highfi.prepare(scene) if model == "reference" else highfi.condense(scene, 0.004)
    assert str(caught.value).count("loose") == 1
    assert highfi.prepare(channels()).cells.size


def test_a_rail_without_mounts_is_refused_wherever_it_gives_way():
    """By the reference and by compliant contact. Springs stand on rigid rails, which are part of the
    platform whatever holds them."""
    scene = tiny(rail__mounts=[])
    for make in (highfi.prepare, lambda each: highfi.condense(each, 0.008)):
        with pytest.raises(SceneError) as caught:
            make(scene)
        assert [fault.key for fault in caught.value.faults] == ["rail.mounts"]
    held, loose = tipoff.run(tiny(), "springs"), tipoff.run(scene, "springs")
    np.testing.assert_array_equal(loose.rate, held.rate)


@pytest.mark.parametrize("off, refused", [(0.5e-6, False), (2e-6, True)])
def test_a_wall_out_of_place_on_both_sides_of_the_bound(tmp_path, off, refused):
    mesh = channel.build()
    mesh.points[mesh.points[:, 1] > 0.0, 1] += off
    scene = from_file(channels(), saved(mesh, tmp_path / "rails.msh"))
    if not refused:
        assert highfi.prepare(scene).cells.size
    else:
        with pytest.raises(SceneError, match="rail.clearance"):
            highfi.prepare(scene)


def test_a_file_without_the_surfaces_and_with_turned_elements(tmp_path):
    mesh = channel.build()
    mesh.cells[0].data[[4, 41]] = mesh.cells[0].data[[4, 41]][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    mesh.field_data["clamp"] = mesh.field_data.pop("mount")
    path = saved(mesh, tmp_path / "rails.msh")
    with pytest.raises(MeshError) as caught:
        highfi.prepare(from_file(channels(), path))
    text = str(caught.value)
    assert text.startswith(f"{path} cannot be used:")
    assert (
        "inverted or flat elements: 5, 42" in text
        and "no quadrilateral group named 'mount'" in text
    )


@pytest.mark.parametrize(
    "name, content", [("rails.msh", b"no mesh at all"), ("rails.xyz", b""), ("rails.vtu", b"<xml")]
)
def test_a_file_that_no_reader_takes_is_a_fault_not_an_exit(tmp_path, name, content, capfd):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MeshError, match="cannot be used: (as a file of|a mesh file ends in)"):
        highfi.prepare(from_file(channels(), tmp_path / name))
    assert capfd.readouterr().out == ""


def test_a_file_that_changes_after_the_scene_was_read_is_refused(tmp_path):
    scene = from_file(channels(), saved(channel.build(), tmp_path / "rails.msh"))
    with open(tmp_path / "rails.msh", "ab") as stream:
        stream.write(b"\n")
    with pytest.raises(MeshError, match="has changed since"):
        highfi.prepare(scene)


@pytest.mark.case("X14")
def test_slivers_are_warned_about_with_the_step_they_force(tmp_path):
    """A brick of the 7075 alloy with an edge of 5 um: pressure waves at 6,161 m/s cross it in 0.811
    ns."""
    mesh = l_rail.build(geometry(tiny()), 0.004)
    mesh.points[np.isclose(mesh.points[:, 0], -0.084), 0] = -0.088 + 5e-6
    cost, step, run = highfi.prepare(
        from_file(tiny(), saved(mesh, tmp_path / "rails.msh"))
    ).warnings
    assert "slivers: elements 1, " in cost
    assert "force a step of at most 8.1" in step and "e-10 s" in step
    # A cube of 4 mm is crossed in 0.45 us, so all 58 ms take 570 times its steps.
    times, steps = float(run.split("need ")[1].split()[0]), float(run.split("mm: ")[1].split()[0])
    assert times == pytest.approx(570.0, rel=0.05) and "cubes of 4 mm" in run
    assert steps == pytest.approx(tiny().duration / (0.9 * 8.13e-10), rel=0.01)


@pytest.mark.gmsh
@pytest.mark.parametrize("duration", ["6 ms", pytest.param("8 ms", marks=pytest.mark.slow)])
def test_the_built_in_rails_from_cad_give_the_same_run(tmp_path, duration):
    built = tiny(
        duration=duration,
        thrust_offset__misalignment__axial="1 deg",
        rail=load("clamped").rail.model_dump(),
    )
    drawing = scene_of(drawn(tmp_path / "rails.step", l_sections), l_surfaces()).rail
    first, second = (
        highfi.run(scene, COARSE)
        for scene in (built, built.replace({"rail": drawing.model_dump()}))
    )
    assert np.abs(first.pad_force).max() > 100.0
    assert np.abs(second.rate - first.rate).max() <= 1e-9 * np.abs(first.rate).max()
