"""Results of the agreement study: those of ``tiny`` with other numbers."""

from dataclasses import fields, replace

from pydantic_core import to_jsonable_python

from tests.studies import kept
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.agreement.stage import STAGE, Agreement
from tipoff.studies.agreement.verdicts import Context, Gates, Refinement

GATES = Gates(0.05, 1e-3, 0.1)
KEPT: Agreement = kept.result(STAGE)
ROW = replace(
    KEPT.compliant[0],
    condition="phi15",
    role="held_out",
    velocity_relative_l2=None,
    rate_relative_l2=0.0033,
    settled_rate_error_deg_s=0.012,
    settled_rate_error_xyz_deg_s=None,
    floor_deg_s=0.03,
    floor_l2=0.002,
    floor_measured_here=True,
    reference_uncertainty_deg_s=0.02,
    reference_uncertainty_by_cause_deg_s={"mesh": 0.02},
    reference_uncertainty_measured_here=True,
    reference_converged=True,
    touches=True,
    judged_as=verdicts.CURVE,
    gates={},
    judgement=verdicts.AGREES,
    verdict=verdicts.AGREES,
    interface=(),
)
SPEEDUP = replace(
    KEPT.speedup,
    condition="phi15",
    ratio=183.2,
    low=180.0,
    high=190.0,
    highfi_wall_s=1.03,
    lowfi_wall_s=5.6e-3,
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
EMPTY = {
    item.name: () for item in fields(KEPT) if isinstance(getattr(KEPT, item.name), tuple | list)
}


def table(**parts) -> Agreement:
    """A result with these ``parts`` and without rows."""
    values = EMPTY | {
        "rail_compliance": None,
        "rail_modes": 4,
        "gates": GATES,
        "element_size_m": 2e-3,
        "speedup": SPEEDUP,
        "speedup_compliant": SPEEDUP,
    }
    return replace(KEPT, **values | parts)


def document(**parts) -> dict:
    """The same as the content of its file."""
    return to_jsonable_python(table(**parts))


def context(uncertainty=0.01, known=True) -> Context:
    """The verdicts on ``phi15`` where the mesh changes its rates by this ``uncertainty`` (deg/s)."""
    change = 0.0 if known else None
    found = Refinement(
        condition="phi15",
        model="reference",
        cause="mesh",
        sizes=[2.0, 1.0],
        rate_relative_l2=change,
        settled_rate_change_deg_s=0.0,
        uncertainty_deg_s=uncertainty,
        order=1.0,
        method="GCI",
    )
    return Context([], [found], GATES)
