"""The compliance of a long rail from the nodes under its pads: as from all places of the pads, as from one
solution of the whole mesh, and the same from its file."""

import numpy as np
import pytest

from tipoff import scenes
from tipoff.highfi import compliance
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.rail import nodal
from tipoff.highfi.statics import solve
from tipoff.highfi.statics.held import HeldRail
from tipoff.mechanics.rail_compliance import RailCompliance, content
from tipoff.mechanics.rail_compliance import nodal as kept

SIZE, SPACING = 0.02, 8e-3  # m
SAME = 1e-11  # relative


@pytest.fixture(scope="module")
def scene():
    """A rocket on 1 m of its rail."""
    mounts = [{"start": start, "end": start + 0.06} for start in (0.06, 0.8)]
    return scenes.load("rocket_rail").replace({"rail.end": 0.28, "rail.mounts": mounts})


def thinner(held: HeldRail) -> HeldRail:
    """The rail with a back that becomes thinner from end to end: no two of its slices are equal."""
    points = held.rail.points.copy()
    low, high = points[:, 0].min(), points[:, 0].max()
    back = points[:, 2] < points[:, 2].min() + 1e-3
    points[back, 2] += 1e-3 * (points[back, 0] - low) / (high - low)
    rail = RailMesh(points, held.rail.cells, held.rail.surfaces)
    return HeldRail(rail, held.images, held.material, held.joint)


@pytest.fixture(scope="module", params=["uniform", "thinner"])
def both(request, scene):
    """From the nodes, from all places, and the rail."""
    found, held = [], compliance.rails(scene, SIZE)
    if request.param == "thinner":
        held = [thinner(each) for each in held]
    with pytest.MonkeyPatch.context() as patch:
        for least in (0.0, np.inf):
            patch.setattr(nodal, "LEAST_BYTES", least)
            found.append(compliance.condense(scene, SIZE, SPACING, held=held))
    assert found[0].nodes is not None and found[1].nodes is None
    return (*found, held)


def error(one, other, name: str) -> float:
    """Largest difference of a table, of its largest number."""
    first, second = (getattr(each, name) for each in (one, other))
    return float(np.abs(first - second).max() / np.abs(second).max())


def test_tables_from_nodes_are_those_of_all_places(both):
    """Control: with one shape less of the loads on the nodes they are not."""
    few, every, _ = both
    for name in (*kept.Tables._fields, "frequency", "part"):
        assert error(few, every, name) < SAME, name
    nodes = few.nodes
    less = nodes._replace(share=nodes.share[..., :-1], shape=nodes.shape[:, :-1])
    assert error(less.tables(few.rail), every, "flexibility") > 100.0 * SAME


def test_a_place_deflects_as_in_one_solution_of_the_whole_mesh(both, scene):
    """By a sparse factor, for the mean under each face of a unit force on each: between mounts, over a
    mount and near the end, all pads on the rail. Control: the next station has another compliance."""
    found, _, held = both
    own = compliance.inputs.of_scene(scene)
    stations = np.searchsorted(found.travel, [0.02, 0.11, 0.26])
    direct = compliance.of_rails(
        [HeldRail(each.rail, each.images, each.material, each.joint) for each in held],
        own.faces,
        own.reach,
        found.travel[stations],
        patterns=1,
    )
    assert solve.Clamped(held[0].operator, 36).chain is None
    expected = direct.matrix[:, :, 0, :, 0]
    mean = found.compliance()
    assert np.abs(mean[stations] - expected).max() < 1e-9 * expected.max()
    assert np.abs(mean[stations + 1] - expected).max() > 1e-4 * expected.max()


def test_the_file_holds_nodes_and_gives_the_same_bits(both, tmp_path):
    few, every, _ = both
    few.save(tmp_path / "rail.npz")
    found = RailCompliance.load(tmp_path / "rail.npz")
    assert found.hash == few.hash and found.cubic()[0].tobytes() == few.cubic()[0].tobytes()
    assert 10 * (tmp_path / "rail.npz").stat().st_size < len(content(every))


def test_what_follows_from_a_compliance_has_tables_of_its_own(both, tmp_path):
    """Other patterns and rigid walls: their file must not give the tables of the nodes again."""
    few = both[0]
    assert few.rigid().nodes is None
    for number, other in enumerate((few.of_degree(2), few.restricted(3))):
        other.save(tmp_path / f"{number}.npz")
        assert RailCompliance.load(tmp_path / f"{number}.npz").hash == other.hash != few.hash


def test_missing_blocks_are_no_zeros(both):
    few = both[0]
    nodes = few.nodes._replace(layers=few.nodes.layers[1:], blocks=few.nodes.blocks[1:])
    with pytest.raises(ValueError, match="given too few"):
        nodes.tables(few.rail)
