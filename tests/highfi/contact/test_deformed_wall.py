"""Contact on a deformed wall derives from one potential: forces and moments are the slopes of the
stored energy, whatever the pose of the pad and the shape of the wall."""

import numpy as np
import pytest

from tests.highfi import tets
from tests.highfi.blocks import block
from tests.highfi.support import NEUTRAL, loop_on
from tipoff.highfi.contact.pads import FASTEST_APPROACH
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.numerics import Numerics
from tipoff.kernels import rotation
from tipoff.scenes import parse

LENGTH, WIDTH, HEIGHT = 0.06, 0.02, 0.01  # m, of the wall
PAD = 0.1  # m, X of its middle
STIFFNESS = 1e12  # N/m3
RELIEF = 3e-6  # m
PLACES = {
    "inside": (0.003, 0.0007),
    "over the end": (0.0257, 0.0007),
    "over the side": (0.003, 0.0071),
    "over the corner": (0.0257, -0.0071),
}


def scene(relief: float):
    """A pad of 16 x 10 mm that faces +y, 0.1 m from the mass centre along X, without friction."""
    return parse(
        NEUTRAL
        | {
            "name": "pad",
            "duration": 1e-4,
            "pads": [
                {
                    "position": [PAD, 0.05, 0.02],
                    "normals": ["+y"],
                    "length": 0.016,
                    "width": 0.010,
                    "relief": relief,
                }
            ],
            "payload": {"mass": 1.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}},
            "rail": {
                "start": PAD - 0.5 * LENGTH,
                "end": PAD + 0.5 * LENGTH,
                "material": {"density": 2700.0, "youngs_modulus": 70e9, "poisson_ratio": 0.3},
            },
            "contact": {
                "law": "linear",
                "clearance": 1e-6,
                "stiffness": 1.0,
                "interface_stiffness": STIFFNESS,
            },
        },
        bare_numbers_are_si=True,
    )


def wall(kind: str) -> RailMesh:
    """A plate whose touched face is at y = 0.05 m + 1 um, of bricks, of twisted hexahedra or of
    tetrahedra."""
    mesh = block((10, 1, 4), (LENGTH, HEIGHT, WIDTH))
    if kind == "tetrahedra":
        mesh = tets.split(mesh)
    facets = boundary_facets(mesh.cells)
    points = mesh.points + np.array([PAD - 0.5 * LENGTH, 0.05 + 1e-6, 0.02 - 0.5 * WIDTH])
    low, high = points.min(axis=0), points.max(axis=0)
    if kind == "twisted":
        inside = ((points > low) & (points < high))[:, [0, 2]].all(axis=1)
        random = np.random.default_rng(3)
        points[inside] += 1e-3 * random.uniform(-1.0, 1.0, (inside.sum(), 3)) * [1.0, 0.0, 1.0]
    touched, far = ((points[facets][:, :, 1] == place).all(axis=1) for place in (low[1], high[1]))
    return RailMesh(points, mesh.cells, {"contact_y": facets[touched], "mount": facets[far]})


class Pressed:
    """A pad on a wall with a wavy displacement."""

    def __init__(self, kind: str, relief: float = RELIEF, cells: int | None = None):
        self.loop = loop_on(scene(relief), wall(kind), Numerics(cells=cells))
        rail = self.loop.setup.system.rail
        free = rail.inverse_mass > 0.0
        x, z = rail.points[free, 0] - PAD, rail.points[free, 2]
        self.loop.stepper.state.displacement[free, 1] = 2e-6 * np.sin(90.0 * x) * np.cos(120.0 * z)
        self.loop.stepper.state.displacement[free, 0] = 1e-6 * np.cos(50.0 * x)
        self.touched = np.unique(self.loop.setup.system.surface.facets)

    def energy(self, place, turn=(0.0, 0.0, 0.0)) -> float:
        """Energy (J) stored with the middle of the pad at ``place`` (m) and the payload turned by a
        rotation vector; the loop then holds the forces."""
        state = self.loop.stepper.state
        state.payload.position[:] = place
        state.payload.quaternion[:] = rotation.exponential(np.array(turn))
        self.loop.stepper.active.wait[:] = 0
        self.loop.stepper.evaluate()
        return float(state.load["stored"][0])

    def resistance(self) -> np.ndarray:
        """Resistance (n,3) N of the nodes after the last ``energy``."""
        return self.loop.stepper.state.resistance.copy()


def slope(function, step: float) -> float:
    """Derivative at zero, by differences of order four."""
    near, far = (function(width) - function(-width) for width in (step, 2.0 * step))
    return (8.0 * near - far) / (12.0 * step)


@pytest.mark.case("O56")
@pytest.mark.parametrize("kind", ["bricks", "twisted", "tetrahedra"])
@pytest.mark.parametrize("where", PLACES)
def test_forces_are_slopes_of_the_stored_energy(kind, where):
    """With respect to the place and the attitude of the payload, and to the displacement of each
    touched node, inside the wall and over its borders."""
    pad = Pressed(kind)
    x, z = PLACES[where]
    place, turn = np.array([x, 6e-6, z]), np.array([0.3e-3, -0.2e-3, 0.15e-3])
    far = place - [0.0, 1.0, 0.0]
    assert pad.energy(far, turn) == 0.0
    # However far away, it waits no longer than a millimetre takes.
    assert (
        0
        <= pad.loop.stepper.active.wait[0]
        <= 1e-3 / (FASTEST_APPROACH * pad.loop.setup.stepping.dt_s)
    )
    elastic = pad.resistance()
    stored = pad.energy(place, turn)
    load, on_rail = pad.loop.stepper.state.load[0].copy(), elastic - pad.resistance()
    assert stored > 0.0 and load["normal_force"][1] < -100.0
    expected = [
        -slope(lambda way, axis=axis: pad.energy(place + way * axis, turn), 1e-9)
        for axis in np.eye(3)
    ]
    scale = np.abs(load["normal_force"]).max()
    assert load["normal_force"] == pytest.approx(expected, abs=2e-6 * scale)
    # Control: the parts along the wall are well above that error.
    assert np.abs(load["normal_force"][[0, 2]]).min() > 1e-5 * scale
    turned = [
        -slope(lambda angle, axis=axis: pad.energy(place, combined(angle * axis, turn)), 1e-8)
        for axis in np.eye(3)
    ]
    assert load["moment"] == pytest.approx(turned, abs=2e-6 * scale * 0.1)
    displacement = pad.loop.stepper.state.displacement
    for node in pad.touched[:: max(1, pad.touched.size // 20)]:
        before = displacement[node, 1]

        def moved(way, node=node, before=before):
            displacement[node, 1] = before + way
            return pad.energy(place, turn)

        force = -slope(moved, 1e-9)
        displacement[node, 1] = before
        assert on_rail[node, 1] == pytest.approx(force, abs=2e-6 * scale)
    assert on_rail[:, [0, 2]] == pytest.approx(0.0, abs=1e-9 * scale)
    assert on_rail.sum(axis=0)[1] == pytest.approx(-load["normal_force"][1], rel=1e-9)


@pytest.mark.parametrize("kind", ["bricks", "twisted", "tetrahedra"])
def test_a_wall_that_tilts_is_met_where_it_is(kind):
    """On a wall of linear displacement each cell has the exact gap, whatever the facets: force and
    moment are sums over the cells by hand."""
    pad = Pressed(kind, relief=0.0)
    points, touched = pad.loop.setup.system.rail.points, pad.touched
    tilt_x, tilt_z = 2e-5, -3e-5
    field = 1e-6 + tilt_x * (points[touched, 0] - PAD) + tilt_z * points[touched, 2]
    pad.loop.stepper.state.displacement[:] = 0.0
    pad.loop.stepper.state.displacement[touched, 1] = field
    place = np.array([0.003, 6e-6, 0.0007])
    stored = pad.energy(place)
    cells = pad.loop.setup.system.surface.cells[0]
    x, z = (
        middle + half * ((2.0 * np.arange(count) + 1.0) / count - 1.0)
        for middle, half, count in zip((0.003, 0.0207), (0.008, 0.005), cells)
    )
    depth = 5e-6 - (1e-6 + tilt_x * x[:, None] + tilt_z * z)
    assert (depth > 0.0).all()
    push = STIFFNESS * 0.016 * 0.010 / depth.size * depth
    load = pad.loop.stepper.state.load[0]
    assert stored == pytest.approx(0.5 * (push * depth).sum(), rel=1e-9)
    expected = push.sum() * np.array([tilt_x, -1.0, tilt_z])
    assert load["normal_force"] == pytest.approx(expected, rel=1e-9)
    about_z = -(push * (x + PAD - place[0])[:, None]).sum() - expected[0] * 0.05
    assert load["moment"][2] == pytest.approx(about_z, rel=1e-9)


def combined(small: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Rotation vector of ``turn`` followed by a ``small`` one about scene axes, to first order in
    the latter and second in the former (Baker, Campbell, Hausdorff)."""
    return turn + small + 0.5 * np.cross(small, turn) + np.cross(turn, np.cross(turn, small)) / 12.0


@pytest.mark.case("O57")
def test_a_tilted_pad_dragged_along_the_wall_does_no_work():
    """On a level wall its force along the wall is zero at any pose. On a wavy one the work between
    two places is the difference of the stored energies, as steps get shorter: the force jumps by the
    slope of the wall from facet to facet."""
    pad, turn = Pressed("bricks", relief=0.0), np.array([0.2e-3, 0.0, -1.5e-3])
    way = np.array([1.0, 0.0, 0.0])

    def dragged(steps: int) -> tuple[float, float]:
        places = np.linspace(-0.015, 0.005, steps + 1)
        energy, force = [], []
        for x in places:
            energy.append(pad.energy([x, 155e-6, 0.0], turn))
            force.append(float(pad.loop.stepper.state.load["normal_force"][0] @ way))
        work = -np.trapezoid(force, places)
        return work - (energy[-1] - energy[0]), np.ptp(energy)

    errors = [dragged(steps) for steps in (800, 12800)]
    assert abs(errors[1][0]) < 1e-4 * errors[1][1] and abs(errors[1][0]) < 0.1 * abs(errors[0][0])
    pad.loop.stepper.state.displacement[:] = 0.0
    for x in np.linspace(-0.015, 0.005, 21):
        assert pad.energy([x, 155e-6, 0.0], turn) > 0.0
        load = pad.loop.stepper.state.load[0]
        assert abs(load["normal_force"][0]) < 1e-12 * abs(load["normal_force"][1])
    # Control: a force along the normal of the tilted pad would do this much work over 20 mm.
    assert abs(load["normal_force"][1]) * 1.5e-3 * 0.02 > 100.0 * np.abs(errors[1][0])
