"""Effect of a rail that no pad touches: whether a run may leave it out, before the first touch or
altogether."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.support import COARSE, last_sample, loop_on, tiny
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import choose
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.simulation import Loop
from tipoff.scenes import load

FLOOR = 0.016  # deg/s: what 1 um of clearance changes on the reference scene


def rail_of(points: np.ndarray) -> np.ndarray:
    """Which of the four rails places (...,3) belong to."""
    return (points[..., 1] > 0.0) + 2 * (points[..., 2] > 0.0)


def touched(loop: Loop, first: int = 0) -> set[int]:
    """Rails that a pad pressed in the samples from number ``first`` on."""
    faces = np.flatnonzero(np.abs(np.array(loop.recorded.forces[first:])).max(axis=(0, 2)))
    return set(rail_of(loop.setup.system.faces.centre[faces]).tolist())


def stiffened(mesh: RailMesh, rails: set[int]) -> RailMesh:
    """``mesh`` with all nodes of the named rails fixed to the platform: they then move with it as
    parts of a rigid body."""
    cells = mesh.cells[np.isin(rail_of(mesh.points[mesh.cells[:, 0]]), list(rails))]
    ends = np.concatenate([cells[:, :4], cells[:, 4:]])
    return replace(
        mesh, surfaces=mesh.surfaces | {"mount": np.concatenate([mesh.surfaces["mount"], ends])}
    )


def deflections(loop: Loop, mesh: RailMesh) -> Iterator[tuple[int, float]]:
    """Each rail when a pad first touches it, with the largest displacement (m) of its walls along
    their normals a sample earlier."""
    walls = [(mesh.surfaces[name], axis) for name, axis in (("contact_y", 1), ("contact_z", 2))]
    owner, known, before = rail_of(mesh.points), set(), {}
    while len(loop.recorded.rows) <= last_sample(loop):
        loop.advance_one_sample()
        new = touched(loop, len(loop.recorded.forces) - 1) - known
        yield from ((rail, before[rail]) for rail in sorted(new))
        known |= new
        moved = loop.stepper.state.displacement[loop.setup.system.number]
        before = {
            rail: max(
                float(np.abs(moved[facets, axis][owner[facets] == rail]).max())
                for facets, axis in walls
            )
            for rail in range(4)
        }


@pytest.mark.slow  # a set of effects of its own: a kernel to compile
def test_on_a_fixed_platform_an_untouched_rail_stays_at_rest():
    """To the last bit, so that leaving it out would change nothing. Control: on a free one it does
    not."""
    early = {
        "duration": "9 ms",
        "contact__clearance": "0.05 mm",
        "thrust_offset__misalignment__radial": "0 deg",
    }
    for platform, moves in (({"platform": None}, False), ({}, True)):
        scene = tiny(**early, **platform)
        mesh = highfi.prepare(scene, COARSE)
        loop = loop_on(scene, mesh, COARSE)
        loop.begin()
        while len(loop.recorded.rows) <= last_sample(loop):
            loop.advance_one_sample()
        used = touched(loop)
        assert 0 < len(used) < 4
        moved = loop.stepper.state.displacement[loop.setup.system.number]
        still = ~np.isin(rail_of(mesh.points), list(used))
        assert np.abs(moved[~still]).max() > 1e-8
        assert bool(moved[still].any()) == moves


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["phi0", "phi15", "phi35"])
def test_on_a_free_platform_it_cannot_be_left_out(condition):
    """Two rails are never touched; as rigid ones they change a settled rate by 2e-7 (phi35) to
    1.3e-6 (phi0) of it. The acceleration of the platform bends the others, so at first touch they
    are up to 5 nm away from their place. A rail that is integrated only from then on would have
    that error, which the conditioning of the scene turns into up to 2e-5 of a rate."""
    scene, numerics = load("clamped").condition(condition), Numerics()
    mesh = highfi.prepare(scene, numerics)
    system = build(scene, numerics, mesh)
    stepping = choose(system, scene, numerics)
    loops = [Loop(set_up(scene, system, stepping))]
    loops[0].begin()
    off = dict(deflections(loops[0], mesh))
    unused = set(range(4)) - set(off)
    assert len(unused) == 2
    loops.append(Loop(set_up(scene, build(scene, numerics, stiffened(mesh, unused)), stepping)))
    loops[1].begin()
    loops[1].integrate(None)
    rates = [np.array(loop.trajectory({}, numerics).outcome.rate) for loop in loops]
    change = np.abs(rates[1] - rates[0]).max() / np.abs(rates[0]).max()
    waiting = np.radians(FLOOR) * max(off.values()) / 1e-6 / np.abs(rates[0]).max()
    assert 1e-8 < change < 3e-6 and waiting < 1e-4
    assert max(change, waiting) > 1e-6
