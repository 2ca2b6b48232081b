"""Results of the agreement study made by hand."""

from pydantic_core import to_jsonable_python

from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.agreement.verdicts import Row
from tipoff.workspace.timing import Speedup

METRICS = dict.fromkeys(
    (
        "velocity_relative_l2",
        "sprague_geers_magnitude",
        "sprague_geers_phase",
        "settled_rate_error_xyz_deg_s",
        "lateral_velocity_difference_m_s",
        "direction_error_difference_deg",
    )
)
ROW = Row(
    **METRICS,
    condition="phi15",
    role="held_out",
    reference_status="exited",
    surrogate_status="exited",
    rate_relative_l2=0.0033,
    settled_rate_error_deg_s=0.012,
    iso18571=1.0,
    iso18571_channels={},
    sprague_geers_channels={},
    floor_deg_s=0.03,
    floor_l2=0.002,
    floor_measured_here=True,
    reference_uncertainty_deg_s=0.02,
    reference_uncertainty_by_cause_deg_s={"mesh": 0.02},
    reference_uncertainty_measured_here=True,
    reference_converged=True,
    touches=True,
    gates={},
    judgement=verdicts.AGREES,
    verdict=verdicts.AGREES,
)
SPEEDUP = Speedup(
    condition="phi15",
    ratio=183.2,
    low=180.0,
    high=190.0,
    highfi_wall_s=1.03,
    lowfi_wall_s=5.6e-3,
    highfi_wall_range_s=(1.0, 1.1),
    lowfi_wall_range_s=(5e-3, 6e-3),
    elements=600,
    highfi_repeats=1,
    lowfi_repeats=1,
    kernel_ratio=None,
    cpu_ratio=None,
    repeats_identical=None,
    hardware={},
)

EQUAL = EqualAccuracy(
    **vars(SPEEDUP) | {"condition": "phi35", "highfi_wall_s": 250.0, "lowfi_wall_s": 5e-3},
    error_deg_s=0.01,
    element_size_m=1e-3,
    mesh_uncertainty_deg_s=0.012,
    surer=True,
)


def table(**parts) -> Agreement:
    """A result with these ``parts`` and without rows."""
    rows = ("uncalibrated", "fitted", "held_out", "compliant", "modal", "floor", "refinement")
    more = ("growth", "distributions", "simpler", "interface")
    empty: dict = dict.fromkeys((*rows, *more), ())
    values = {
        "rail_compliance": None,
        "rail_modes": 4,
        "gates": verdicts.Gates(0.05, 0.001, 0.1),
        "element_size_m": 2e-3,
        "converged_deg_s": verdicts.CONVERGED_DEG_S,
        "clearance_change_m": 1e-6,
        "speedup": SPEEDUP,
        "speedup_compliant": SPEEDUP,
    }
    return Agreement(**(empty | values | parts))


def document(**parts) -> dict:
    """The same as the content of its file."""
    return to_jsonable_python(table(**parts))
