"""Two-step Coulomb friction with static and dynamic coefficients and transition speeds (the law of
ADAMS/Solver CONTACT).

With s = |v| the sliding speed, v_s the static and v_d the dynamic transition speed::

    mu(s) = mu_s (3 r - r^3) / 2,  r = s / v_s                      s <= v_s
    mu(s) = mu_s + (mu_d - mu_s) x^2 (3 - 2 x),  x = (s - v_s)/(v_d - v_s)   v_s < s < v_d
    mu(s) = mu_d                                                    s >= v_d

The first branch is the cubic step from -mu_s at -v_s to mu_s at v_s. The force is ``-mu(s) N v/s``.
Absent table: none. The other law is ``law = "sticking"`` (``scenes.effects.sticking``), without
creep.
"""

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from tipoff.kernels.jit import njit
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.effects.sticking import StickingTable
from tipoff.scenes.faults import Fault, SceneError
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

    def record(self) -> "Friction":
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


class Friction(NamedTuple):
    """Kernel record of the two-step Coulomb law."""

    static: float  # coefficient
    dynamic: float  # coefficient
    static_speed: float  # m/s
    dynamic_speed: float  # m/s


@njit
def coefficient_over_speed(friction, speed):
    """mu(s)/s (s/m) at sliding speed ``speed`` >= 0 (m/s); finite at rest, where the slip has no
    direction."""
    if speed <= friction.static_speed:
        ratio = speed / friction.static_speed
        return 0.5 * friction.static * (3.0 - ratio * ratio) / friction.static_speed
    if speed >= friction.dynamic_speed:
        return friction.dynamic / speed
    x = (speed - friction.static_speed) / (friction.dynamic_speed - friction.static_speed)
    return (
        friction.static + (friction.dynamic - friction.static) * x * x * (3.0 - 2.0 * x)
    ) / speed
