"""Stresses of a run under refinement: the filtered peak on the patches, and the peak of the whole
rail.

Contact and walls ring with the modes of the elements, so the mean stress of each patch is filtered
like contact forces (``studies.convergence.contact_loads``) before its von Mises stress is computed.
The peak of the whole rail is at a sharp inner corner or at the border of a clamp, if there is one.
There the stress of linear elasticity is infinite, so the peak grows with every refinement. A section
with a fillet on joints has neither.
"""

from tipoff.results.trajectory import Trajectory
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene
from tipoff.studies.convergence import contact_loads

PEAK = "peak stress of the rail"
SINGULAR = "mesh-dependent: stress has no limit at a sharp corner or clamp"


def has_limit(scene: Scene) -> bool:
    """Whether the peak of the whole rail has a limit: a fillet and joints. Of rails from files it is
    not known."""
    rail = scene.rail
    return isinstance(rail, SectionTable) and None not in (rail.fillet, rail.mount_stiffness)


def patch_peak(scene: Scene, run: Trajectory) -> float | None:
    """Largest von Mises stress (Pa) of any patch below the cut-off frequency; None for a run
    without patches."""
    from tipoff.highfi.elements.hexahedral_recovery import von_mises  # slow to load

    if run.wall_stress is None or not run.wall_stress.size:
        return None
    return float(von_mises(contact_loads.low_passed(scene, run.wall_stress)).max())


def facts(run: Trajectory) -> dict:
    """Peak stress as in the rows of result files, all None for a run without stress."""
    found = run.stress or {}
    if place := found.get("peak_stress_place_m"):
        found = found | {"peak_stress_place_m": tuple(place)}
    return {
        name: found.get(name)
        for name in (
            "peak_stress_pa",
            "peak_stress_place_m",
            "peak_stress_rail",
            "peak_stress_time_s",
            "yield_strength_pa",
            "largest_strain",
            "largest_rotation_rad",
        )
    } | {"warnings": tuple(found.get("warnings", ()))}
