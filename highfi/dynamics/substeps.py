"""Substeps: parts of a step, used while friction damps nodes too fast for a whole step.

Friction near rest is a damper mu' N at each contact, and the nodes of a fine mesh are light. So a
payload at rest on its rails damps them faster than any sliding contact (``step_limit`` has the
condition). All nodes and bodies then take substeps. The elastic force stays the same in them, so a
run becomes more expensive; its ``cost`` has their number.

A whole step still ends at the same time, so the times of samples stay. The kernel returns after the
step in which the damping exceeds the limit. The number of substeps is reduced only at multiples of
``step_size.RASTER``, so the sampling interval changes no bit of the result.
"""

from tipoff.highfi.dynamics.step_size import Stepping
from tipoff.highfi.dynamics.stepper import Stepper

MOST = 1000  # substeps of a step
# Ratio of the damping that chooses the substeps to the present one, so that growing contact does
# not change them repeatedly.
_SPARE = 1.25


def needed(stepping: Stepping, damping: float) -> int:
    """Number of substeps for ``damping`` (1/s); ``MOST`` + 1 if ``MOST`` are not sufficient."""
    count = 1
    while count <= MOST and not (
        stepping.used(count) + 0.5 * damping * stepping.dt_s / count <= 1.0
    ):
        count += 1
    return count


def too_many(stepper: Stepper) -> bool:
    """Whether friction needs more than ``MOST`` substeps."""
    return needed(stepper.setup.stepping, stepper.damping) > MOST


def adapt(stepper: Stepper) -> int:
    """Divide the next steps as friction requires; returns the number of steps until the next
    decision."""
    setup, damping = stepper.setup, stepper.damping
    if damping > stepper.most_damping:
        stepper.divide(min(needed(setup.stepping, _SPARE * damping), MOST))
    elif stepper.substeps > 1 and stepper.steps % setup.interval == 0:
        fewer = needed(setup.stepping, _SPARE * max(damping, stepper.fastest))
        stepper.divide(min(fewer, stepper.substeps))
    if stepper.substeps == 1:
        return setup.most + 1
    return setup.interval - stepper.steps % setup.interval
