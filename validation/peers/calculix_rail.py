"""The rails of the catalogue in CalculiX: a load, the lowest frequencies, a thermal bow.

For the element C3D8I both codes have the same meshes. C3D20R is more accurate: it shows which part of the
difference is due to the mesh.
"""

from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from tipoff.highfi import Numerics, prepare
from tipoff.highfi.elements import hexahedral_recovery as recovery
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly, thermal
from tipoff.highfi.statics.pressure import Wall
from tipoff.highfi.statics.solve import Clamped
from tipoff.scenes.rail_base import MaterialTable
from tipoff.scenes.scene import Scene, load
from validation.peers import calculix
from validation.peers.calculix import LINEAR, QUADRATIC
from validation.peers.case import OURS, Case, Point, extrapolated, percent, timed

FORCE = 100.0  # N
WARM, GRADIENT = 20.0, 500.0  # K, K/m along y
SIDE = 0.016  # m, side of the loaded square, that of a pad
_START = 0.056  # m from the rear end of the rail, as between two mounts
_POINTS = 8  # of integration, in C3D8I and in C3D20R
_FREE = 0.008  # m from a mount; the stress of the clamp within it is left out


class Setting(NamedTuple):
    """The peer's element, its size and ours (mm)."""

    kind: str
    theirs: float
    ours: float


SETTINGS = {
    "C3D8I 4 mm, ours 4 mm": Setting(LINEAR, 4.0, 4.0),
    "C3D8I 2 mm, ours 2 mm": Setting(LINEAR, 2.0, 2.0),
    "C3D20R 2 mm, ours 1 mm": Setting(QUADRATIC, 2.0, 1.0),
}
_SLOW = tuple(name for name, chosen in SETTINGS.items() if chosen.ours < 4.0)
# Of a rail with a fillet on joints. In elements of 4 mm the square begins between nodes.
FINEST = "C3D20R 2 mm, ours from 2 and 1 mm"
ON_JOINTS = {
    "C3D8I 2 mm, ours 2 mm": Setting(LINEAR, 2.0, 2.0),
    FINEST: Setting(QUADRATIC, 2.0, 1.0),
}
JOINTS_MATCHED = "mesh with a fillet, material, joints; in C3D8I the element too"
JOINTS_UNMATCHED = "in CalculiX a joint is a layer of 10 µm"


@cache
def rail(name: str, size: float) -> tuple[Scene, RailMesh]:
    """A scene of the catalogue, and the first of its rails in elements of ``size`` (mm)."""
    scene = load(name)
    return scene, pieces.distinct(prepare(scene, Numerics(element_size=1e-3 * size)))[0][0]


def constants(material: MaterialTable) -> tuple[float, float, float]:
    """Density (kg/m3), Young's modulus (Pa), Poisson's ratio."""
    return material.density, material.youngs_modulus, material.poisson_ratio


class Patch(NamedTuple):
    """The loaded square on a wall whose normal is along y."""

    facets: np.ndarray  # (m,4)
    middle: np.ndarray  # (2,) m, x and z
    side: int  # sign of the pressure along y


def supported(of: calculix.Solid, scene: Scene, mesh: RailMesh) -> str:
    """The mounts of a rail: held, or on the joints of its scene."""
    joint, facets = scene.rail.joint(), mesh.surfaces["mount"]
    return calculix.joined(of, facets, joint) if joint else calculix.held(of, facets)


def patch(mesh: RailMesh) -> Patch:
    """The square of the wall with the normal y, from its free edge and between two mounts."""
    facets = mesh.surfaces["contact_y"]
    plane = mesh.points[facets].mean(axis=1)[:, [0, 2]]
    x, z = mesh.points[:, 0].min() + _START, np.abs(mesh.points[facets][..., 2]).min()
    away = np.sign(mesh.points[facets][..., 2].mean())
    low, high = np.array([x, z]), np.array([x, z]) + SIDE
    within = (np.array([1.0, away]) * plane > low) & (np.array([1.0, away]) * plane < high)
    inside = facets[within.all(axis=1)]
    middle = 0.5 * (low + high) * [1.0, away]
    return Patch(inside, middle, int(np.sign(mesh.points[inside][..., 1].mean())))


def loaded_here(name: str, chosen: Setting) -> dict[str, float]:
    """Mean deflection of the patch and the largest stress, by the statics of the reference."""
    scene, mesh = rail(name, chosen.ours)
    square, wall = patch(mesh), mesh.surfaces["contact_y"]
    half = np.full(2, 0.5 * SIDE)
    under = Wall(mesh.points, wall, 2).pressed(square.middle, half, 1)
    assert under is not None
    force = np.zeros(mesh.points.shape)
    np.add.at(force[:, 1], under.node, FORCE * square.side * under.load[0])
    operator = assembly.of_material(mesh, scene.rail.material, joint=scene.rail.joint())
    moved = Clamped(operator).displaced(force.reshape(-1, 1), np.zeros((force.size, 1)))
    moved = moved.reshape(-1, 3)
    deflection = (force[:, 1] * moved[:, 1]).sum() / FORCE
    return {"deflection": 1e6 * deflection} | _stresses(chosen, _stress_here(scene, mesh, moved))


def _stresses(chosen: Setting, at_points: np.ndarray) -> dict[str, float]:
    """The mean over the points and, if both codes have the same points, the largest value. The
    largest value is at an inner corner and grows on finer meshes."""
    found = {"mean stress": 1e-6 * float(at_points.mean())}
    if chosen.kind == LINEAR:
        found["largest stress"] = 1e-6 * float(at_points.max())
    return found


def _stress_here(scene: Scene, mesh: RailMesh, moved: np.ndarray) -> np.ndarray:
    """Von Mises stress (Pa) at the Gauss points of the elements away from clamps."""
    chosen = mesh.cells[_away_from_clamps(mesh)]
    law = hexahedron.elasticity(
        scene.rail.material.youngs_modulus, scene.rail.material.poisson_ratio
    )
    return recovery.von_mises(
        hexahedron.gauss_strain(mesh.points[chosen], law, moved[chosen]) @ law
    )


def _away_from_clamps(mesh: RailMesh) -> np.ndarray:
    """Numbers of the elements farther than ``_FREE`` from every mount along X."""
    middle = mesh.points[mesh.cells][..., 0].mean(axis=1)
    held = mesh.points[mesh.surfaces["mount"]][..., 0].mean(axis=1)
    return np.flatnonzero(np.abs(middle[:, None] - np.unique(held)).min(axis=1) > _FREE)


def loaded_there(name: str, chosen: Setting) -> dict[str, float]:
    """The same by CalculiX."""
    scene, mesh = rail(name, chosen.theirs)
    of, square = calculix.solid(mesh, chosen.kind), patch(mesh)
    _, _, nodes = calculix.sides(of, square.facets)
    deck = calculix.head(of, constants(scene.rail.material))
    deck += supported(of, scene, mesh)
    deck += calculix.members("NSET", "PATCH", nodes)
    away = _away_from_clamps(mesh)
    deck += calculix.members("ELSET", "AWAY", away)
    deck += "*STEP\n*STATIC\n" + calculix.pressure(of, square.facets, FORCE / SIDE**2)
    deck += "*NODE PRINT, NSET=PATCH\nU\n*EL PRINT, ELSET=AWAY\nS\n*END STEP\n"
    answer = calculix.run(deck)
    table = answer.table("displacements", len(np.unique(nodes)), 1.0)
    along = dict(zip(table[:, 0].astype(int) - 1, table[:, 2]))
    weight = calculix.shares(nodes)
    mean = np.mean([[along[node] for node in face] @ weight for face in nodes.tolist()])
    # xx, yy, zz, xy, xz, yz behind the element and its point
    stress = answer.table("stresses", _POINTS * len(away), 1.0)[:, 2:8]
    found = {"deflection": 1e6 * square.side * mean, "cpu_s": answer.cpu_s}
    return found | _stresses(chosen, recovery.von_mises(stress))


def bowed_here(chosen: Setting) -> dict[str, float]:
    """Displacement of the open end of a warm rail."""
    scene, mesh = rail("clamped", chosen.ours)
    warm = scene.replace({"thermal.mean": WARM, "thermal.gradient.y": GRADIENT})
    assert warm.thermal is not None
    moved = thermal.displacement(mesh, scene.rail.material, warm.thermal.record(scene.rail))
    return _at_end(mesh, moved)


def _at_end(mesh: RailMesh, moved: np.ndarray) -> dict[str, float]:
    """Displacement (um) of the corners of the open end: the largest of each component."""
    end = np.flatnonzero(mesh.points[:, 0] > mesh.points[:, 0].max() - 1e-9)
    size = 1e6 * np.abs(moved[end]).max(axis=0)
    return {"along": size[0], "across y": size[1], "across z": size[2]}


def bowed_there(chosen: Setting) -> dict[str, float]:
    """The same by CalculiX, from temperatures at its nodes."""
    scene, mesh = rail("clamped", chosen.theirs)
    of, material = calculix.solid(mesh, chosen.kind), scene.rail.material
    warm = WARM + GRADIENT * of.points[:, 1]
    extra = f"*EXPANSION\n{material.expansion:.13g}\n"
    deck = calculix.head(of, constants(material), extra)
    deck += calculix.held(of, mesh.surfaces["mount"])
    end = np.flatnonzero(mesh.points[:, 0] > mesh.points[:, 0].max() - 1e-9)
    deck += calculix.members("NSET", "END", end)
    deck += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNSOLID,0\n*STEP\n*STATIC\n*TEMPERATURE\n"
    deck += "".join(f"{node + 1},{value:.13g}\n" for node, value in enumerate(warm))
    deck += "*NODE PRINT, NSET=END\nU\n*END STEP\n"
    answer = calculix.run(deck)
    size = 1e6 * np.abs(answer.table("displacements", len(end), 1.0)[:, 1:]).max(axis=0)
    return {"along": size[0], "across y": size[1], "across z": size[2], "cpu_s": answer.cpu_s}


def _load_within(name: str, setting: str, quantity: str) -> float:
    """Equal elements on held nodes differ by the printed digits of CalculiX. On joints they differ by
    the layer that stands for a joint, and C3D20R by the mesh."""
    if setting != FINEST and SETTINGS[setting].kind == LINEAR:
        return {"clamped": 1e-6, "reference": 5e-4}[name]
    return 3e-3 if quantity == "deflection" else 2e-2


def _bow_within(setting: str, _: str) -> float:
    """C3D8I uses the mean temperature of an element, which is an error of a tenth at 4 mm, and of a
    fourth of that at 2 mm."""
    return {4.0: 0.1, 2.0: 0.03, 1.0: 0.02}[SETTINGS[setting].ours]


def _work() -> list[Point]:
    """Deflection of the patch, against C3D20R in elements of 2 mm."""
    finest = Setting(QUADRATIC, 2.0, 1.0)
    exact, _ = timed(lambda: loaded_there("clamped", finest))
    points = []
    for size in (4.0, 2.0, 1.0):
        chosen = Setting(LINEAR, size, size)
        found, spent = timed(partial(loaded_here, "clamped", chosen))
        error = percent(found["deflection"], exact["deflection"])
        points.append(Point(OURS, f"{size:g} mm", error, spent))
    for kind, size in ((LINEAR, 4.0), (LINEAR, 2.0), (QUADRATIC, 4.0)):
        chosen = Setting(kind, size, size)
        found, spent = timed(partial(loaded_there, "clamped", chosen))
        error = percent(found["deflection"], exact["deflection"])
        points.append(Point(f"CalculiX {kind}", f"{size:g} mm", error, spent))
    return points


def cases() -> tuple[Case, ...]:
    """A load on a rail with clamped mounts and on one with joints, and a thermal bow."""
    shared = "mesh, material, held nodes; in C3D8I the element too"
    bow = Case(
        name="calculix-bow",
        title="Displacement of the open end of a warm rail of scene `clamped`",
        inputs=lambda: {"scene": "clamped", "mean_k": WARM, "gradient_y_k_m": GRADIENT},
        matched=f"{shared}; temperature at the nodes",
        unmatched="CalculiX takes the mean temperature of each C3D8I, tipoff its linear field "
        "with the incompatible modes under load",
        settings=tuple(SETTINGS),
        units=dict.fromkeys(("along", "across y", "across z"), "um"),
        ours=lambda setting: bowed_here(SETTINGS[setting]),
        theirs=lambda setting: bowed_there(SETTINGS[setting]),
        within=_bow_within,
        slow=_SLOW,
    )
    held = _load("clamped", SETTINGS, f"{shared}; uniform pressure", "nothing")
    joined = _load("reference", ON_JOINTS, f"{JOINTS_MATCHED}; uniform pressure", JOINTS_UNMATCHED)
    return replace(held, work=_work, error_of="deflection of a rail"), joined, bow


def _load(name: str, settings: dict[str, Setting], matched: str, unmatched: str) -> Case:
    def ours(setting: str) -> dict[str, float]:
        found = loaded_here(name, settings[setting])
        if setting != FINEST:
            return found
        coarse = loaded_here(name, Setting(QUADRATIC, 2.0, 2.0))
        return extrapolated(coarse, {"deflection": found["deflection"]})

    return Case(
        name="calculix-load" if name == "clamped" else f"calculix-load-{name}",
        title=f"Rail of scene `{name}` under 100 N on a square of 16 mm between two mounts",
        inputs=lambda: {"scene": name, "force_n": FORCE, "side_m": SIDE},
        matched=matched,
        unmatched=unmatched,
        settings=tuple(settings),
        units={"deflection": "um", "mean stress": "MPa", "largest stress": "MPa"},
        ours=ours,
        theirs=lambda setting: loaded_there(name, settings[setting]),
        within=partial(_load_within, name),
        slow=tuple(key for key, chosen in settings.items() if chosen.ours < 4.0),
    )
