"""Two-step Coulomb friction (``mechanics.laws.friction``). Absent table: none. The other law is
``law = "sticking"`` (``scenes.effects.sticking``), without creep.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from tipoff.faults import Fault, SceneError
from tipoff.mechanics.laws.friction import Friction
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.effects.sticking import StickingTable
from tipoff.scenes.rounding import at_most
from tipoff.scenes.table import Table
from tipoff.scenes.units import NonNegativeNumber, PositiveVelocity

EFFECT = Effect("friction")


class TwoStepTable(Table):
    """``[friction]``: coefficients (dimensionless) and transition speeds (m/s)."""

    # The default law. It is not written, so that scenes without this key keep their hash.
    #: Two-step Coulomb friction.
    law: Literal["two-step"] = Field("two-step", exclude=True)
    #: Static coefficient.
    static: NonNegativeNumber
    #: Dynamic coefficient.
    dynamic: NonNegativeNumber
    #: Sliding speed at which friction is static.
    static_speed: PositiveVelocity
    #: Sliding speed from which on friction is dynamic.
    dynamic_speed: PositiveVelocity

    @field_validator("dynamic_speed")
    @classmethod
    def _speeds_in_order(cls, dynamic_speed: float, info: ValidationInfo):
        if at_most(dynamic_speed, info.data.get("static_speed", 0.0)):
            raise ValueError("a speed above static_speed")
        return dynamic_speed

    def record(self) -> Friction:
        """Kernel record."""
        return Friction(self.static, self.dynamic, self.static_speed, self.dynamic_speed)


def require_two_step(scene) -> None:
    """Check for a solver without other laws. Raises SceneError if ``scene`` has one."""
    if scene.friction is not None and scene.friction.law != "two-step":
        raise SceneError(
            [
                Fault(
                    scene.name,
                    "friction.law",
                    repr(scene.friction.law),
                    "'two-step', the only law of this solver",
                )
            ]
        )


def _with_law(raw: Any) -> Any:
    return {"law": "two-step"} | raw if isinstance(raw, dict) else raw


FrictionTable = Annotated[
    TwoStepTable | StickingTable, Field(discriminator="law"), BeforeValidator(_with_law)
]
