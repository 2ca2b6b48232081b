"""Memory is checked before it is used: what a run will need, what is available, and the refusal
when that is less."""

import pytest
import typer
from typer.testing import CliRunner

from tests.highfi.support import tiny
from tests.meshes.test_solid import drawn, drilled, flat, mesh_here, scene_of
from tipoff import highfi
from tipoff.highfi import Numerics, simulation
from tipoff.highfi.mesh import split
from tipoff.highfi.rail import memory_estimate
from tipoff.highfi.rail.geometry import geometry
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.meshes import l_rail
from tipoff.scenes import SceneError, load
from tipoff.studies.single.command import run
from validation.bench.command import bench

MEMINFO = "MemTotal:       16000000 kB\nMemFree:         1000000 kB\nMemAvailable:    8000000 kB\n"


@pytest.mark.parametrize(
    "name, size",
    [
        ("reference", 0.004),
        ("reference", 0.003),
        ("reference", 0.0021),
        ("tiny", 0.016),
        ("tiny", 0.008),
        ("tiny", 0.005),
    ],
)
def test_number_of_elements_is_predicted(name, size):
    section = geometry(load(name))
    mesh = l_rail.build(section, size)
    assert l_rail.elements(section, size) == sum(
        len(block.data) for block in mesh.cells if block.type == "hexahedron"
    )


@pytest.mark.parametrize(
    "elements, measured", [(154_880, 0.35e9), (1_239_040, 2.7e9), (4_050_000, 8.7e9)]
)
def test_estimate_is_what_was_measured(elements, measured):
    """Within a quarter, and not below."""
    assert measured <= memory_estimate.of_section(elements) <= 1.25 * measured


def files(folder, **contents):
    """A file system that holds nothing but the given files."""
    for path, text in contents.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder


def test_available_memory_is_read_from_the_machine(tmp_path):
    assert memory_estimate.available(tmp_path) is None
    assert memory_estimate.available(files(tmp_path, **{"proc/meminfo": MEMINFO})) == 8_192_000_000


@pytest.mark.parametrize(
    "line, folder, names",
    [
        ("0::/a/b\n", "", ("memory.max", "memory.current", "inactive_file")),
        (
            "4:memory:/a/b\n1:cpu:/\n",
            "memory/",
            ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
        ),
    ],
)
def test_control_group_and_those_around_it_count(tmp_path, line, folder, names):
    """3 GB less 2 GB in use, of which half a GB is cached files; the group itself has no limit."""
    limit, used, cached = names
    unlimited = "max" if limit == "memory.max" else "9223372036854771712"
    around, own = (f"sys/fs/cgroup/{folder}{place}" for place in ("a", "a/b"))
    files(
        tmp_path,
        **{
            "proc/meminfo": MEMINFO,
            "proc/self/cgroup": line,
            f"{around}/{limit}": "3000000000\n",
            f"{around}/{used}": "2000000000\n",
            f"{around}/memory.stat": f"anon 5\n{cached} 500000000\n",
            f"{own}/{limit}": f"{unlimited}\n",
            f"{own}/{used}": "2000000000\n",
        },
    )
    assert memory_estimate.available(tmp_path) == 1_500_000_000


def test_section_that_does_not_fit_is_refused_before_it_is_meshed(monkeypatch):
    """The fault has both numbers and a size that fits; at that size the check passes. Control:
    without the check the mesh would be begun."""
    monkeypatch.setattr(memory_estimate, "available", lambda: 2_000_000_000)
    monkeypatch.setattr(simulation, "make_mesh", lambda *_: pytest.fail("meshed"))
    with pytest.raises(SceneError) as caught:
        highfi.prepare(load("reference"), Numerics(element_size=0.00025))
    (fault,) = caught.value.faults
    assert fault.key == "element_size" and "9,912,320 elements" in fault.given
    assert "23 GB" in fault.given and "2 GB can be had" in fault.given
    size = 1e-3 * float(fault.expected.split()[0])
    with pytest.raises(pytest.fail.Exception, match="meshed"):
        highfi.prepare(load("reference"), Numerics(element_size=size))


def test_mesh_of_a_file_that_leaves_too_little_is_refused(monkeypatch):
    """7,240 hexahedra, most of one shape. One limit is below what they need, and one is exceeded
    only if all shapes differ."""
    scene = load("channel")
    mesh = highfi.prepare(scene)
    elements, nodes = mesh.cells.shape
    simulation.MESHES.clear()
    monkeypatch.setattr(
        memory_estimate, "available", lambda: 0.9 * memory_estimate.of_mesh(elements, nodes, 0)
    )
    with pytest.raises(SceneError, match="a coarser file"):
        highfi.prepare(scene)
    monkeypatch.setattr(
        memory_estimate,
        "available",
        lambda: 0.9 * memory_estimate.of_mesh(elements, nodes, elements),
    )
    assert highfi.prepare(scene).cells.shape == (elements, nodes)


def test_a_file_is_not_split_where_its_parts_do_not_fit(monkeypatch):
    """An element size of 0.05 mm instead of 4 mm asks for half a million times the elements."""
    monkeypatch.setattr(memory_estimate, "available", lambda: 8_000_000_000)
    monkeypatch.setattr(split, "to_size", lambda *_: pytest.fail("split"))
    with pytest.raises(SceneError) as caught:
        highfi.prepare(load("channel"), Numerics(element_size=5e-5))
    (fault,) = caught.value.faults
    assert fault.key == "element_size" and "753,664,000 elements" in fault.given


@pytest.mark.gmsh
@pytest.mark.parametrize("elements, mesh_of", [("hex8", make_mesh), ("tet10", mesh_here)])
def test_a_solid_is_not_filled_where_its_elements_do_not_fit(
    tmp_path, monkeypatch, elements, mesh_of
):
    """40 x 20 x 8 mm less a hole of 10 mm through it, in elements of 10 um."""
    monkeypatch.setattr(memory_estimate, "available", lambda: 8_000_000_000)
    top, below = (flat(2, z, [(0, 0), (0.04, 0.02)]) for z in (0.008, 0.0))
    scene = scene_of(
        drawn(tmp_path / "block.step", drilled), {"contact_top": [top], "mount": [below]}, 0.0, 0.04
    ).replace({"rail.elements": elements})
    with pytest.raises(
        SceneError, match=r"[56],\d{3},\d{3},\d{3} elements take about .* of memory"
    ):
        mesh_of(scene, 1e-5)


@pytest.mark.parametrize(
    "command, options",
    [
        (run, ["--all", "--model", "finite-elements", "--set", "studies.element_size=1 mm"]),
        (bench, ["--element-size", "1"]),
    ],
)
def test_commands_report_it_without_a_traceback(tmp_path, monkeypatch, command, options):
    monkeypatch.setattr(memory_estimate, "available", lambda: 100_000_000)
    simulation.MESHES.clear()
    app = typer.Typer()
    app.command()(command)
    result = CliRunner().invoke(app, [*options, "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert (
        "GB of memory" in result.stderr
        and "0.1 GB can be had" in result.stderr
        and "Traceback" not in result.output
    )


def test_other_systems_are_not_checked(monkeypatch):
    monkeypatch.setattr(memory_estimate, "available", lambda: None)
    assert highfi.prepare(tiny(), Numerics(element_size=0.008)).cells.size


def test_estimate_of_a_mesh_bounds_its_arrays():
    """The matrices of elements no two of which are alike are the largest part."""
    matrices = 8 * 30 * 30 * 1000
    assert (
        3 * matrices
        < memory_estimate.of_mesh(1000, 10, 1000) - memory_estimate.FIXED
        < 4 * matrices
    )
