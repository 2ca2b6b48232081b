"""Structural (Rayleigh) damping of the rails, ``C = alpha M + beta K``, of the reference and of its
modes in the surrogate. Absent table: none.

A mode of angular frequency w has the damping ratio ``alpha / 2w + beta w / 2`` (Clough and Penzien,
Dynamics of Structures, section 12-5). It equals the two given ratios at the two given frequencies,
is smaller between them and larger outside.
"""

import math

from pydantic import ValidationInfo, field_validator

from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.rounding import below
from tipoff.scenes.table import Table
from tipoff.scenes.units import DampingRatio, Frequency

# The ratios of an aluminium rail without joints. Larger ones shorten the step of the reference.
EFFECT = Effect(
    "rail.damping",
    {
        "rail.damping.ratios": [0.001, 0.001],
        "rail.damping.frequencies": ["500 Hz", "5 kHz"],
    },
)


class DampingTable(Table):
    """``[rail.damping]``: two frequencies (Hz), ascending, and the damping ratio at each.

    Neither alpha nor beta may be negative, because a mode would then gain energy. With q = f2 / f1
    this requires z1 / q <= z2 <= q z1.
    """

    #: Two frequencies, the lower one first.
    frequencies: tuple[Frequency, Frequency]
    #: Damping ratio at each of the two frequencies.
    ratios: tuple[DampingRatio, DampingRatio]

    @field_validator("frequencies")
    @classmethod
    def _ascending(cls, frequencies):
        if not below(*frequencies):
            raise ValueError("two different frequencies, the lower one first")
        return frequencies

    @field_validator("ratios")
    @classmethod
    def _possible(cls, ratios, info: ValidationInfo):
        first, second = info.data.get("frequencies", (0.0, math.inf))
        quotient = second / first if first > 0.0 else math.inf
        low, high = ratios[0] / quotient, min(quotient * ratios[0], 1.0) if ratios[0] > 0.0 else 0.0
        if below(ratios[1], low) or below(high, ratios[1]):
            raise ValueError(
                f"a second ratio from {low:.6g} to {high:.6g}, the range for these frequencies "
                f"and a first ratio of {ratios[0]:g}"
            )
        return ratios

    def record(self) -> Damping:
        """Kernel record."""
        (one, two), (first, second) = (
            self.ratios,
            (2.0 * math.pi * frequency for frequency in self.frequencies),
        )
        scale = 2.0 / ((second - first) * (second + first))
        mass_rate, stiffness_time = (
            scale * first * second * (one * second - two * first),
            scale * (two * second - one * first),
        )
        # At the limit of the possible ratios one of the two is zero, except for rounding.
        return Damping(max(0.0, mass_rate), max(0.0, stiffness_time))
