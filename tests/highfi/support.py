"""Scenes and meshes shared by the tests of the coupled solver."""

import functools
import math
from contextlib import suppress
from dataclasses import replace

import meshio
import numpy as np

from tipoff import highfi
from tipoff.highfi.dynamics import resting
from tipoff.highfi.dynamics.resting import Rails
from tipoff.highfi.dynamics.setup import set_up
from tipoff.highfi.dynamics.step_size import Stepping, choose
from tipoff.highfi.dynamics.system import System, build, general_elements
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import Loop
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import load

COARSE = Numerics(element_size=0.008)
# Effects of the tiny scene without strength. Each set of effects that are present is one more
# kernel, which takes ten seconds and more to compile, so scenes of one effect have the others too.
IMMOVABLE = {"mass": 1e15, "inertia": {"xx": 1e15, "yy": 1e15, "zz": 1e15}}
SMOOTH = {"static": 0.0, "dynamic": 0.0, "static_speed": 1e-3, "dynamic_speed": 2e-3}
NO_THRUST = {"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 0.0}
CENTRED = {"eccentricity": {"axial": 0.0}}
UNTOUCHED = {"law": "linear", "clearance": 1e-6, "stiffness": 1.0, "interface_stiffness": 1.0}
NEUTRAL = {
    "platform": IMMOVABLE,
    "contact": UNTOUCHED,
    "friction": SMOOTH,
    "thrust": NO_THRUST,
    "thrust_offset": CENTRED,
}
# Changes to the tiny scene by which pads touch after half a millisecond.
SOON = {
    "duration": "1.5 ms",
    "contact__clearance": "0.05 mm",
    "initial": {"velocity": {"x": 1.0, "y": 0.1, "z": 0.02}},
}


def tiny(**overrides):
    """The tiny scene at clock angle 15 deg, with dotted overrides given with double underscores."""
    return (
        load("tiny")
        .condition("phi15")
        .replace({key.replace("__", "."): value for key, value in overrides.items()})
    )


@functools.cache
def whole() -> Trajectory:
    """The run of the small scene that nothing interrupts, made once; nobody changes it."""
    return highfi.run(tiny(), COARSE)


def bar_mesh(length: float, width: float, layers: int, across: int = 1) -> RailMesh:
    """Straight bar along X from the origin: ``mount`` is the root section, ``contact_y`` one
    side."""
    x, y = np.linspace(0.0, length, layers + 1), np.linspace(-width / 2, width / 2, across + 1)
    points = np.stack(np.meshgrid(x, y, y, indexing="ij"), axis=-1).reshape(-1, 3)

    def node(i, j, k):
        return (i * (across + 1) + j) * (across + 1) + k

    cells = [(i, j, k) for i in range(layers) for j in range(across) for k in range(across)]
    hexes = [
        [
            node(i, j, k),
            node(i + 1, j, k),
            node(i + 1, j + 1, k),
            node(i, j + 1, k),
            node(i, j, k + 1),
            node(i + 1, j, k + 1),
            node(i + 1, j + 1, k + 1),
            node(i, j + 1, k + 1),
        ]
        for i, j, k in cells
    ]
    root = [
        [node(0, j, k), node(0, j, k + 1), node(0, j + 1, k + 1), node(0, j + 1, k)]
        for j in range(across)
        for k in range(across)
    ]
    side = [
        [
            node(i, across, k),
            node(i, across, k + 1),
            node(i + 1, across, k + 1),
            node(i + 1, across, k),
        ]
        for i in range(layers)
        for k in range(across)
    ]
    quads = root + side
    tags = [1] * len(root) + [2] * len(side)
    return read(
        meshio.Mesh(
            points,
            [("hexahedron", hexes), ("quad", quads)],
            cell_data={"gmsh:physical": [[3] * len(hexes), tags]},
            field_data={
                "mount": np.array([1, 2]),
                "contact_y": np.array([2, 2]),
                "rail": np.array([3, 3]),
            },
        )
    )


def reachable(surface, face: int) -> np.ndarray:
    """Numbers of the facets that a pad face can come over."""
    search = surface.search
    wall = search.wall[face]
    first = search.first_bin[wall]
    begin, end = search.first_facet[[first, first + search.bins[wall].prod()]]
    return np.unique(search.facet[begin:end])


def loop_on(scene, mesh: RailMesh, numerics: Numerics = Numerics()) -> Loop:
    """A run in progress on a mesh of the test's own."""
    system = build(scene, numerics, mesh)
    return Loop(set_up(scene, system, choose(system, scene, numerics)))


def assert_same_bits(one, other, *more: str) -> None:
    """That two trajectories are equal to the bit, in ``more`` fields too."""
    names = (
        "position",
        "velocity",
        "quaternion",
        "rate",
        "platform_velocity",
        "pad_force",
        "energy",
        "transverse_energy",
    )
    for name in (*names, *more):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


def replace_constants(loop: Loop, **constants) -> None:
    """Give a run in progress other constants."""
    loop.stepper.setup = replace(loop.setup, **constants)


def last_sample(loop: Loop) -> int:
    """Number of the last sample at the time limit of a run; the first one has number zero."""
    scene = loop.setup.scene
    return scene.output.last(scene.time_limit)


class Stopped(Exception):
    """Ends a run after the part that a test needs."""


class _StopAt:
    """In the place of a run's checkpoint: ends the run after ``samples`` samples."""

    def __init__(self, samples: int):
        self.samples = samples

    def keep(self, loop: Loop) -> None:
        """End the run there."""
        if len(loop.recorded.rows) > self.samples:
            raise Stopped


_PARTS: dict = {}  # what ``parts`` made, which no run changes


def parts(scene, numerics: Numerics = COARSE) -> tuple[System, Stepping, Rails | None]:
    """What loops of a scene are made of, as by ``highfi.run``, made once."""
    key = scene.hash, numerics
    if key not in _PARTS:
        system = build(scene, numerics, highfi.prepare(scene, numerics))
        stepping = choose(system, scene, numerics)
        rails = None if numerics.step_everything else resting.build(scene, system, stepping)
        _PARTS[key] = system, stepping, rails
    return _PARTS[key]


def without_columns(system: System) -> System:
    """``system`` for the kernel of elements, as if its rails were no extrusion."""
    assert system.rail.columns is not None
    elements = general_elements(system.mesh.points, system.operator, system.number)
    return system._replace(rail=system.rail._replace(columns=None, elements=elements))


def begun(scene=None, numerics: Numerics = COARSE, threads: int = 1, columns: bool = True) -> Loop:
    """A loop at its first sample, as ``highfi.run`` makes it, or ``without_columns``."""
    scene = scene or tiny()
    system, stepping, rails = parts(scene, numerics)
    if not columns:
        system = without_columns(system)
        rails = resting.build(scene, system, stepping)
    loop = Loop(set_up(scene, system, stepping, threads, rails))
    loop.begin()
    return loop


def stopped(samples: int, scene=None, numerics: Numerics = COARSE) -> Loop:
    """A loop integrated for ``samples`` samples after the first one."""
    loop = begun(scene, numerics)
    go_on(loop, samples)
    return loop


def go_on(loop: Loop, samples: int) -> None:
    """Integrate until there are ``samples`` samples after the first one."""
    with suppress(Stopped):
        loop.integrate(None, _StopAt(samples))


def spinning_bar_stretch(
    density: float, rate: float, length: float, youngs_modulus: float
) -> float:
    """Tip displacement (m) of a bar turning about its root: rho w^2 L^3 / (3 E) (Timoshenko and
    Goodier, rotating bar)."""
    return density * rate**2 * length**3 / (3.0 * youngs_modulus)


def degrees(values):
    return [math.degrees(value) for value in values]
