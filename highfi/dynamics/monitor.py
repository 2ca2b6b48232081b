"""Stress of the rails during a run: the peaks over all elements, and the gauges on the walls, both at
samples. Both contain thermal stress (``statics.thermal``).

A scan of all elements costs as much as up to eight steps (``stress.peaks``). The interval between
scans limits their cost to a twentieth of the run. The result has a warning if the peaks exceed the
yield strength or the range of small strain and small rotation: then they are not valid for a real
rail.
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
from tipoff.highfi.stress.peak import ROTATION, STRAIN, STRESS, Peak
from tipoff.mechanics.laws.thermal import Thermal, fields
from tipoff.scenes.rail_base import MaterialTable

_SHARE = 0.05  # largest share of scans in the run
# strain: its neglected square is then 0.5 % of it; most metals yield before
LARGEST_STRAIN = 0.01
# rad: a rotation that seems a strain of half its square, 2e-4, which in aluminium is 14 MPa
LARGEST_ROTATION = 0.02
_OFF_AXIS = 1e-3  # m: a rail whose middle is nearer to a plane of symmetry is on no side of it


class Monitor(NamedTuple):
    """Constants of the stress monitor of one run."""

    recovery: peaks.Recovery  # of all elements
    workspaces: np.ndarray  # (threads, peaks.SIZE)
    patch: patch.Patch | None  # of the gauges, None without gauges
    # (w,6) Pa, subtracted from the stress of the gauges (free expansion is no stress), or None
    free: np.ndarray | None
    every: int  # samples from one scan to the next
    shear_modulus: float  # Pa
    lame: float  # Pa, Lame's first constant


def build(system: System, material: MaterialTable, steps_per_sample: int, threads: int) -> Monitor:
    """Stress monitor of the rails of ``system``."""
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
    return Monitor(
        recovery=recovery,
        workspaces=np.zeros((threads, peaks.SIZE)),
        patch=gauges,
        free=free,
        every=every,
        shear_modulus=float(law[3, 3]),
        lame=float(law[0, 1]),
    )


def _free_stress(
    thermal: Thermal, origin: np.ndarray, gauges: patch.Patch, law: np.ndarray
) -> np.ndarray:
    """D m e (w,6) Pa of the free strain e in the middle of each patch, equal to its mean there."""
    strain = fields(gauges.centre + origin, thermal.middle) @ thermal.amounts[:-1]
    return np.outer(strain, law[:, :3].sum(axis=1))


def gauge(monitor: Monitor, displacement: np.ndarray) -> np.ndarray:
    """Mean stress (w,6) Pa of each patch, if there are patches."""
    assert monitor.patch is not None
    found = patch.stress(monitor.patch, displacement)
    return found if monitor.free is None else found - monitor.free


def scan(monitor: Monitor, displacement: np.ndarray, time: float, peak: Peak, pool) -> None:
    """Raise ``peak`` to the values of all elements at ``time`` (s); each thread of ``pool`` scans a
    part of them."""
    bounds = np.linspace(0, len(monitor.recovery.cells), len(monitor.workspaces) + 1).astype(int)
    found = [Peak(*(part.copy() for part in peak)) for _ in monitor.workspaces]
    tasks = list(zip(found, monitor.workspaces, bounds[:-1], bounds[1:]))
    others = [pool.submit(peaks.find, displacement, monitor.recovery, *task) for task in tasks[1:]]
    peaks.find(displacement, monitor.recovery, *tasks[0])
    for other in others:
        other.result()
    # in the order of the elements, so that the result does not depend on the number of threads
    for part in found:
        higher = part.square > peak.square
        peak.square[higher], peak.place[higher], peak.time[higher] = (
            part.square[higher],
            part.place[higher],
            time,
        )


def record(monitor: Monitor, system: System, peak: Peak, yield_strength: float | None) -> dict:
    """Peaks and gauges of a result, as in ``Trajectory.stress``."""
    mesh, origin, (element_number, node) = system.mesh, system.origin, peak.place[STRESS]
    place = mesh.points[mesh.cells[element_number, node]]
    found = {
        "peak_stress_pa": monitor.shear_modulus * math.sqrt(peak.square[STRESS]),
        "peak_stress_place_m": place.tolist(),
        "peak_stress_rail": rail_name(mesh, int(element_number)),
        "peak_stress_time_s": float(peak.time[STRESS]),
        "yield_strength_pa": yield_strength,
        "largest_strain": math.sqrt(peak.square[STRAIN]),
        "largest_rotation_rad": math.sqrt(peak.square[ROTATION]),
        "samples_between_looks": monitor.every,
        "patch_places_m": [] if monitor.patch is None else (monitor.patch.centre + origin).tolist(),
    }
    return found | {"warnings": warnings(found)}


def warnings(found: dict) -> list[str]:
    """Reasons why the stresses of a record are not valid for a real rail, one sentence each."""
    texts, strength = [], found["yield_strength_pa"]
    if strength is not None and found["peak_stress_pa"] > strength:
        texts.append(
            f"von Mises stress of {1e-6 * found['peak_stress_pa']:.4g} MPa is above the yield "
            f"strength, "
            f"{1e-6 * strength:.4g} MPa: the real rail would yield there, this one stays elastic"
        )
    if found["largest_strain"] > LARGEST_STRAIN:
        texts.append(
            f"strain of {100.0 * found['largest_strain']:.3g} % is above the "
            f"{100.0 * LARGEST_STRAIN:g} % that small strain allows"
        )
    if found["largest_rotation_rad"] > LARGEST_ROTATION:
        texts.append(
            f"an element turns by {math.degrees(found['largest_rotation_rad']):.3g} deg, above the "
            f"{math.degrees(LARGEST_ROTATION):.3g} deg that small rotation allows"
        )
    return texts


def rail_name(mesh: RailMesh, element_number: int) -> str:
    """Name of the rail with an element, by its side of the axis: "+y -z"; "all" for one piece
    around the axis."""
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
