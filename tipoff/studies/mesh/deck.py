"""The first rail as an input file of CalculiX or Abaqus, for a cross-check: same nodes, elements,
material, mounts and loads, and in its head the answers of tipoff.

Its steps are a force of ``FORCE`` under the first pad at ignition, and the lowest frequencies. The
nodal loads are those of the rail compliance (``highfi.statics.pressure``). Joints are springs
between the nodes of a facet and to the ground, which add up to their matrix (``statics.mounts``). A
hexahedron is C3D8I, which has the incompatible modes of the reference; a tetrahedron is C3D10.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, triu

from tipoff.files import write_text
from tipoff.highfi import compliance
from tipoff.highfi.mesh.cells import HEXAHEDRON, kind
from tipoff.highfi.rail import inputs
from tipoff.highfi.rail.places import Patches
from tipoff.highfi.statics import mounts
from tipoff.highfi.statics.held import HeldRail
from tipoff.mechanics.model import half_sizes
from tipoff.scenes.scene import Scene

FORCE, MODES = 100.0, 4  # N, modes
_PER_LINE = 12
_NO_SPRING = 1e-12  # of the largest entry of the joints


class Answers(NamedTuple):
    """Mean displacement (m) of the wall under the loaded pad against it, and frequencies (Hz)."""

    deflection: float
    frequencies: tuple[float, ...]


def write(scene: Scene, element_size: float, path: Path) -> Answers | None:
    """Write the file; None without a pad on the first rail. Raises SceneError or MeshError."""
    held = compliance.rails(scene, element_size)[0]
    load = _under_first_pad(scene, held)
    if load is None:
        return None
    clamped = held.clamped(0)
    moved = clamped.displaced(FORCE * load[:, None], np.zeros((load.size, 1)))[:, 0]
    frequency, _ = held.modes(MODES)
    found = Answers(float(load @ moved), tuple((frequency / (2.0 * np.pi)).tolist()))
    write_text(path, "\n".join(_lines(scene, held, FORCE * load, found)) + "\n")
    return found


def _under_first_pad(scene: Scene, held: HeldRail) -> np.ndarray | None:
    """Nodal loads (3n,) of a force of 1 N on the wall, spread over the first pad face on it."""
    if scene.contact is None:
        return None
    own, patches = inputs.of_scene(scene), Patches(held.rail, 1)
    half = half_sizes(own.faces)
    number = patches.under(own.faces, half, held.images[0], own.reach, np.zeros(1))[0]
    if not (number >= 0).any():
        return None
    return patches.loads().toarray()[:, number[number >= 0][0]]


def _lines(scene: Scene, held: HeldRail, load: np.ndarray, answers: Answers) -> list[str]:
    rail, material = held.rail, held.material
    element = "C3D8I" if kind(rail.cells) is HEXAHEDRON else "C3D10"
    frequencies = ", ".join(f"{value:.6g}" for value in answers.frequencies)
    loaded = np.flatnonzero(load)
    return [
        f"** First rail of scene {scene.name}, in SI: m, N, kg, s. Written by tipoff view --mesh.",
        f"** {FORCE:g} N under the first pad. tipoff: the wall moves {1e6 * answers.deflection:.6g} um,",
        "** the mean of the displacements of the loaded nodes with their shares of the force.",
        f"** Lowest frequencies by tipoff: {frequencies} Hz.",
        "*NODE, NSET=RAIL",
        *(f"{n},{x:.13g},{y:.13g},{z:.13g}" for n, (x, y, z) in enumerate(rail.points, 1)),
        f"*ELEMENT, TYPE={element}, ELSET=RAIL",
        *(",".join(map(str, (n, *nodes))) for n, nodes in enumerate((rail.cells + 1).tolist(), 1)),
        *(line for name, facets in sorted(rail.surfaces.items()) for line in _set(name, facets)),
        f"*MATERIAL, NAME=MATERIAL\n*ELASTIC\n{material.youngs_modulus:.13g},"
        f"{material.poisson_ratio:.13g}\n*DENSITY\n{material.density:.13g}",
        "*SOLID SECTION, ELSET=RAIL, MATERIAL=MATERIAL",
        *_mounts(held),
        *_set("loaded", loaded // 3),
        "*STEP\n*STATIC\n*CLOAD",
        *(f"{place // 3 + 1},{place % 3 + 1},{load[place]:.13g}" for place in loaded.tolist()),
        *("*NODE PRINT, NSET=LOADED\nU", "*NODE FILE\nU", "*EL FILE\nS", "*END STEP"),
        f"*STEP\n*FREQUENCY\n{MODES}\n*NODE FILE\nU\n*END STEP",
    ]


def _set(name: str, facets: np.ndarray) -> list[str]:
    numbers = (np.unique(facets) + 1).tolist()
    starts = range(0, len(numbers), _PER_LINE)
    return [
        f"*NSET, NSET={name.upper()}",
        *(",".join(map(str, numbers[start : start + _PER_LINE])) for start in starts),
    ]


def _mounts(held: HeldRail) -> list[str]:
    """Held nodes, or the springs of the joints."""
    facets = held.rail.surfaces["mount"]
    if held.joint is None:
        return ["*BOUNDARY\nMOUNT,1,3"]
    matrix = mounts.stiffness(held.rail.points, facets, held.joint)
    return _springs(matrix, len(held.rail.cells))


def _springs(matrix: csr_array, last: int) -> list[str]:
    """Springs with the stiffness ``matrix`` (3n,3n): between two degrees of freedom for each entry
    beside the diagonal, and to the ground for the sum of a row. Elements after number ``last``."""
    pairs = triu(matrix, 1).tocoo()
    ground = np.asarray(matrix.sum(axis=1)).ravel()
    least = _NO_SPRING * abs(matrix).max()
    rows: dict[tuple, list[str]] = {}

    def add(value: float, *freedoms: int) -> None:
        if abs(value) > least:
            key = (*(freedom % 3 + 1 for freedom in freedoms), float(f"{value:.9e}"))
            rows.setdefault(key, []).append(",".join(str(f // 3 + 1) for f in freedoms))

    for freedom in np.flatnonzero(ground).tolist():
        add(ground[freedom], freedom)
    for row, column, value in zip(pairs.row.tolist(), pairs.col.tolist(), pairs.data.tolist()):
        add(-value, row, column)
    lines = []
    for number, ((*directions, value), nodes) in enumerate(rows.items(), 1):
        lines.append(f"*ELEMENT, TYPE=SPRING{len(directions)}, ELSET=JOINT{number}")
        lines += [f"{last + place},{row}" for place, row in enumerate(nodes, 1)]
        lines.append(f"*SPRING, ELSET=JOINT{number}")
        # CalculiX takes a number without a point for a direction
        lines += [",".join(map(str, directions)), f"{value:.12e}"]
        last += len(nodes)
    return lines
