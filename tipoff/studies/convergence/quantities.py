"""Quantities of the convergence study: settled state of the payload, loads of the pads in contact,
stress."""

import math
from collections.abc import Iterator, Sequence

from tipoff.comparison.metrics import AXES
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.convergence import contact_loads, stresses

RATE = "settled rate"


def quantities(
    scene: Scene, runs: Sequence[Trajectory]
) -> Iterator[tuple[str, str, Sequence[float | None]]]:
    """(quantity, unit, value of each run, None if it did not settle); a pad without contact in all
    runs is left out."""
    for index, axis in enumerate(AXES):
        yield f"{RATE} {axis}", "deg/s", [settled_rate(found)[index] for found in runs]
    yield (
        "settled axial velocity",
        "m/s",
        [None if found.outcome.velocity is None else found.outcome.velocity[0] for found in runs],
    )
    impulses = [contact_loads.impulses(scene, found) for found in runs]
    for pad in range(len(scene.pads)):
        if any(found[pad] for found in impulses):
            yield (
                f"contact impulse, pad {pad + 1}",
                "N s",
                [float(found[pad]) for found in impulses],
            )
    if any(found.any() for found in impulses):
        peaks = [contact_loads.filtered_peak(scene, found) for found in runs]
        yield f"peak contact force below {1e-3 * contact_loads.cutoff(scene):g} kHz", "N", peaks
    patches = [peak for found in runs if (peak := stresses.patch_peak(scene, found)) is not None]
    if len(patches) == len(runs):
        yield (
            f"patch stress below {1e-3 * contact_loads.cutoff(scene):g} kHz",
            "MPa",
            [1e-6 * stress for stress in patches],
        )
    peaks_pa = [found.stress["peak_stress_pa"] for found in runs if found.stress]
    if len(peaks_pa) == len(runs):
        yield stresses.PEAK, "MPa", [1e-6 * stress for stress in peaks_pa]


def settled_rate(run: Trajectory) -> list[float | None]:
    """Settled rate (deg/s) about x, y, z."""
    return (
        [None] * len(AXES)
        if run.outcome.rate is None
        else [math.degrees(rate) for rate in run.outcome.rate]
    )
