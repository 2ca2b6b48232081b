"""Clearance and contact between pad faces and rail walls. Absent table: nothing touches.

``clearance_y`` and ``clearance_z`` replace the ``clearance`` of the faces along that axis. The
walls stay one ``clearance`` off the pads as drawn; shims on the faces give the difference.

The laws of springs are in ``mechanics.laws.contact``. The finite elements and compliant contact
have a pressure over approach k_i (N/m3) on the crowned pads, without damping:
the interface stiffness of asperities and coating, in series with the material of the pad, if the
scene states the thickness t of its layer::

    1 / k_i = 1 / interface_stiffness + t / M
    M = E                                       a layer that is free to bulge sideways
    M = E (1 - nu) / ((1 + nu) (1 - 2 nu))      one that cannot: thin beside its width, and bonded

Source of M: Johnson, Contact Mechanics, Cambridge 1985, section 4.3. Values of the interface
stiffness with their sources are in ``docs/interface_stiffness.md``.
"""

from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import Field, ValidationInfo, field_validator

from tipoff.mechanics.laws.contact import ContactLaw
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.rounding import at_most
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import (
    ContactDamping,
    ContactExponent,
    Dissipation,
    InterfaceStiffness,
    NonNegativeLength,
    PoissonRatio,
    PositiveLength,
    Pressure,
    sized,
)
from tipoff.units import parse

EFFECT = Effect("contact")
_Lengths = TypeVar("_Lengths", float, np.ndarray)


class PadLayerTable(Table):
    """``[contact.pad_layer]``: pad material of ``thickness`` (m) and ``youngs_modulus`` (Pa) in
    front of a stiff payload. With a ``poisson_ratio`` it cannot bulge sideways."""

    #: Thickness of the soft layer of a pad.
    thickness: PositiveLength
    #: Young's modulus of the layer.
    youngs_modulus: Pressure
    #: Poisson's ratio of a bonded thin layer; without it the layer bulges freely.
    poisson_ratio: PoissonRatio | None = None

    def stiffness(self) -> float:
        """Pressure over compression (N/m3)."""
        nu = self.poisson_ratio or 0.0
        confined = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
        return self.youngs_modulus * confined / self.thickness


class _ContactTable(Table):
    #: Gap between a face and its wall when the payload is centred.
    clearance: NonNegativeLength
    #: Clearance of the faces along y, if it differs.
    clearance_y: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Clearance of the faces along z, if it differs.
    clearance_z: NonNegativeLength | None = Field(None, exclude_if=is_absent)
    #: Exponent e of the law of the springs.
    exponent: ContactExponent = 1.5
    #: Stiffness k of one face, in N/m**e.
    stiffness: float
    #: Pressure over approach of asperities and coating, in the finite elements and in
    #: compliant contact.
    interface_stiffness: InterfaceStiffness = 1.8e12
    #: Soft material of the pads, in series with the interface.
    pad_layer: PadLayerTable | None = Field(None, exclude_if=is_absent)

    def gaps(self) -> tuple[float, float, float]:
        """Clearance (m) of faces with a normal along x, y and z."""
        y, z = (
            self.clearance if own is None else own for own in (self.clearance_y, self.clearance_z)
        )
        return self.clearance, y, z

    def narrowest(self) -> float:
        """The smaller clearance (m) of the two axes across the rail."""
        return min(self.gaps()[1:])

    def widened(self, change: _Lengths) -> dict[str, _Lengths]:
        """Overrides (SI) of a scene for ``change`` (m) more clearance along both axes."""
        found = {
            f"contact.clearance_{axis}": own + change
            for axis, own in (("y", self.clearance_y), ("z", self.clearance_z))
            if own is not None
        }
        return found if len(found) == 2 else {"contact.clearance": self.clearance + change} | found

    def either_way(self, change: float) -> dict[str, dict[str, float]]:
        """Overrides (SI) of a scene for ``change`` (m) more clearance, "plus", and less clearance,
        "minus"; without "minus" if no clearance would remain."""
        return {
            name: {key: max(gap, 0.0) for key, gap in self.widened(step).items()}
            for name, step in (("plus", change), ("minus", -change))
            if at_most(-step, self.narrowest())
        }

    def series_stiffness(self) -> float:
        """Pressure over approach (N/m3) of the interface and the layer of the pad in series."""
        if self.pad_layer is None:
            return self.interface_stiffness
        return 1.0 / (1.0 / self.interface_stiffness + 1.0 / self.pad_layer.stiffness())

    def stiffened(self, factor: float) -> dict[str, float]:
        """Overrides (SI) of a scene for ``factor`` times the ``series_stiffness``."""
        found = {"contact.interface_stiffness": factor * self.interface_stiffness}
        if self.pad_layer is not None:
            modulus = factor * self.pad_layer.youngs_modulus
            found["contact.pad_layer.youngs_modulus"] = modulus
        return found

    @field_validator("stiffness", mode="before")
    @classmethod
    def _stiffness_matches_exponent(cls, value: Any, info: ValidationInfo) -> float:
        if "exponent" not in info.data:
            return 1.0  # the exponent is refused, so the expected unit is unknown
        bare = bool(info.context and info.context.get("bare_numbers_are_si"))
        unit = f"N/m**{info.data['exponent']:.12g}"
        stiffness = sized(parse(value, unit, bare), unit, is_positive=True)
        if stiffness <= 0.0:
            raise ValueError("greater than 0")
        return stiffness


class ImpactTable(_ContactTable):
    """``[contact] law = "impact"``: k (N/m^e), e, c (N s/m), d (m)."""

    #: IMPACT of ADAMS.
    law: Literal["impact"]
    #: Damping coefficient at full depth.
    damping: ContactDamping
    #: Penetration at which the damping is full.
    damping_depth: PositiveLength

    def record(self) -> ContactLaw:
        """Kernel record."""
        return ContactLaw(
            stiffness=self.stiffness,
            exponent=self.exponent,
            damping=self.damping,
            damping_depth=self.damping_depth,
        )


class HuntCrossleyTable(_ContactTable):
    """``[contact] law = "hunt-crossley"``: k (N/m^e), e, dissipation a (s/m)."""

    #: Law of Hunt and Crossley.
    law: Literal["hunt-crossley"]
    #: Dissipation factor a.
    dissipation: Dissipation

    def record(self) -> ContactLaw:
        """Kernel record."""
        return ContactLaw(
            stiffness=self.stiffness, exponent=self.exponent, dissipation=self.dissipation
        )


class LinearTable(_ContactTable):
    """``[contact] law = "linear"``: spring k (N/m) and damper c (N s/m) that never pull."""

    #: Linear spring and damper that never pull.
    law: Literal["linear"]
    #: Exponent, always 1.
    exponent: Literal[1.0] = 1.0  # type: ignore[valid-type]  # pydantic has literal fractions
    #: Damping coefficient.
    damping: ContactDamping = 0.0

    def record(self) -> ContactLaw:
        """Kernel record."""
        return ContactLaw(stiffness=self.stiffness, damping=self.damping)


ContactTable = Annotated[ImpactTable | HuntCrossleyTable | LinearTable, Field(discriminator="law")]
