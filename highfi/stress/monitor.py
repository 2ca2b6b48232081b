"""Stress of the rails while a run goes on: the worst node of all elements, and the gauges on the
walls, both at samples. That of uneven temperature is part of both (``highfi.statics.thermal``).

A look at all elements costs as much as up to eight steps (``highfi.stress.peaks``), so it is taken at so
many samples only that it stays below a twentieth of the run. What is found is judged at the end:
above the yield strength, or beyond what small strain and small rotation can tell, the figures are
those of a rail that does not exist, and the result says so.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tipoff.highfi.dynamics.system import System
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.stress import gauge as patch
from tipoff.highfi.stress import peaks
from tipoff.highfi.stress.peak import ROTATION, STRAIN, STRESS, Worst
from tipoff.scenes.effects.thermal import Thermal, fields
from tipoff.scenes.rail import MaterialTable

_SHARE = 0.05  # of the run that looks may cost
# its square, left out, is then half a per cent of it; most metals have yielded before
LARGEST_STRAIN = 0.01
# rad: taken for a strain of half its square, 2e-4, which in aluminium is 14 MPa
LARGEST_ROTATION = 0.02
_OFF_AXIS = 1e-3  # m: a rail whose middle is nearer to a plane of symmetry has no side of it


class Watch(NamedTuple):
    """Constant: recovery of all elements, room for one in each thread, patches or None, ``free``
    stress (w,6) Pa to take off theirs, for free expansion is no stress, or None, samples from one
    look to the next, shear modulus and Lame's first constant (Pa)."""

    recovery: peaks.Recovery
    rooms: np.ndarray
    patch: patch.Patch | None
    free: np.ndarray | None
    every: int
    shear_modulus: float
    lame: float


def build(system: System, material: MaterialTable, steps_per_sample: int, threads: int) -> Watch:
    """What watches the rails of ``system``."""
    law = hexahedron.elasticity(material.youngs_modulus, material.poisson_ratio)
    points, operator = system.mesh.points - system.origin, system.operator
    recovery = peaks.build(points, system.mesh.cells, operator.shape_class, law, system.number)
    gauges = patch.find(system.mesh, system.faces, points, law, system.number)
    every = peaks.samples_between(recovery, steps_per_sample, _SHARE)
    free = (
        _free_stress(system.model.thermal, system.origin, gauges, law)
        if system.model.thermal is not None and gauges is not None
        else None
    )
    return Watch(
        recovery,
        np.zeros((threads, peaks.SIZE)),
        gauges,
        free,
        every,
        float(law[3, 3]),
        float(law[0, 1]),
    )


def _free_stress(
    thermal: Thermal, origin: np.ndarray, gauges: patch.Patch, law: np.ndarray
) -> np.ndarray:
    """D m e (w,6) Pa of the free strain e in the middle of each patch, which is its mean there."""
    strain = fields(gauges.centre + origin, thermal.middle) @ thermal.amounts[:-1]
    return np.outer(strain, law[:, :3].sum(axis=1))


def gauge(watch: Watch, displacement: np.ndarray) -> np.ndarray:
    """Mean stress (w,6) Pa of each patch, where there are any."""
    assert watch.patch is not None
    found = patch.stress(watch.patch, displacement)
    return found if watch.free is None else found - watch.free


def look(watch: Watch, displacement: np.ndarray, time: float, worst: Worst, pool) -> None:
    """Raise ``worst`` to what the elements have now, at ``time`` (s), each thread of ``pool``
    looking at its part of them."""
    bounds = np.linspace(0, len(watch.recovery.cells), len(watch.rooms) + 1).astype(int)
    found = [Worst(*(part.copy() for part in worst)) for _ in watch.rooms]
    tasks = list(zip(found, watch.rooms, bounds[:-1], bounds[1:]))
    others = [pool.submit(peaks.find, displacement, watch.recovery, *task) for task in tasks[1:]]
    peaks.find(displacement, watch.recovery, *tasks[0])
    for other in others:
        other.result()
    # in the order of the elements, so that the number of threads does not matter
    for part in found:
        higher = part.square > worst.square
        worst.square[higher], worst.place[higher], worst.time[higher] = (
            part.square[higher],
            part.place[higher],
            time,
        )


def record(watch: Watch, system: System, worst: Worst, yield_strength: float | None) -> dict:
    """What a result says of its stresses: see ``Trajectory.stress``."""
    mesh, origin, (element_number, node) = system.mesh, system.origin, worst.place[STRESS]
    place = mesh.points[mesh.cells[element_number, node]]
    found = {
        "peak_stress_pa": watch.shear_modulus * math.sqrt(worst.square[STRESS]),
        "peak_stress_place_m": place.tolist(),
        "peak_stress_rail": rail_name(mesh, int(element_number)),
        "peak_stress_time_s": float(worst.time[STRESS]),
        "yield_strength_pa": yield_strength,
        "largest_strain": math.sqrt(worst.square[STRAIN]),
        "largest_rotation_rad": math.sqrt(worst.square[ROTATION]),
        "samples_between_looks": watch.every,
        "patch_places_m": [] if watch.patch is None else (watch.patch.centre + origin).tolist(),
    }
    return found | {"warnings": warnings(found)}


def warnings(found: dict) -> list[str]:
    """Why the stresses of a record are not those of a real rail, one sentence each; none where they
    may be."""
    said, strength = [], found["yield_strength_pa"]
    if strength is not None and found["peak_stress_pa"] > strength:
        said.append(
            f"von Mises stress of {1e-6 * found['peak_stress_pa']:.4g} MPa is above the yield "
            f"strength, "
            f"{1e-6 * strength:.4g} MPa: the real rail would yield there, this one stays elastic"
        )
    if found["largest_strain"] > LARGEST_STRAIN:
        said.append(
            f"strain of {100.0 * found['largest_strain']:.3g} % is above the "
            f"{100.0 * LARGEST_STRAIN:g} % that small strain allows"
        )
    if found["largest_rotation_rad"] > LARGEST_ROTATION:
        said.append(
            f"an element turns by {math.degrees(found['largest_rotation_rad']):.3g} deg, above the "
            f"{math.degrees(LARGEST_ROTATION):.3g} deg that small rotation allows"
        )
    return said


def rail_name(mesh: RailMesh, element_number: int) -> str:
    """The rail that holds an element, by the side of the axis it stands on: "+y -z"; "all" for one
    piece around it."""
    nodes, cells = len(mesh.points), mesh.cells
    ends = np.repeat(cells[:, 0], cells.shape[1] - 1), cells[:, 1:].ravel()
    links = coo_array((np.ones(ends[0].size, dtype=bool), ends), shape=(nodes, nodes))
    piece = connected_components(links, directed=False)[1]
    middle = mesh.points[cells[piece[cells[:, 0]] == piece[cells[element_number, 0]]]].mean(
        axis=(0, 1)
    )
    sides = [
        f"{'+' if middle[axis] > 0.0 else '-'}{'xyz'[axis]}"
        for axis in (1, 2)
        if abs(middle[axis]) > _OFF_AXIS
    ]
    return " ".join(sides) or "all"
