"""Parameters of a fit of springs: their physical meaning, their bounds, and the resulting overrides
of a scene. ``calibration.compliant`` has those of compliant contact.

Stiffnesses k in N/m^e of different exponents are not comparable. So the fit varies the elastic
force at the reference penetration p_r = 0.02 mm (loads of 60 to 180 N press a rail of 3e-8 to 1e-7
m/N by 2 to 18 um), and k follows::

    F_r = k p_r^e        B_r = c s(p_r/d),  s(x) = x^2 (3 - 2 x)

B_r is IMPACT's damping coefficient at p_r. For p << d the law depends on c and d only through
c/d^2, so d keeps the scene's value and the fit varies B_r. ``held`` lists d, so that the
information matrix shows how little the curves determine it. Bounds scale with the rail: a pad load P
bends a leg (thickness t, length a) by about P a^2/(E t^3), the scale of a cantilever plate.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from tipoff.faults import Fault, SceneError
from tipoff.scenes.effects.contact import ContactTable, HuntCrossleyTable, ImpactTable, LinearTable
from tipoff.scenes.effects.friction import FrictionTable
from tipoff.scenes.scene import Scene

REFERENCE_PENETRATION = 2e-5  # m
# Largest and smallest static compliance of the reference rail (1e-7 m/N between mounts, 3e-8 at
# one) over a^2/(E t^3).
_SOFT, _STIFF = 1.25, 4.2
_MARGIN = 10.0  # factor from a static estimate to the range of a point contact in impact
# Parameters that are keys of a scene.
_PLAIN = (
    "contact.interface_stiffness",
    "contact.clearance",
    "contact.clearance_y",
    "contact.clearance_z",
    "rail.mount_stiffness.factor",
)


@dataclass(frozen=True)
class Parameter:
    """One coordinate of a fit, searched between its bounds on a logarithmic or linear scale."""

    name: str
    unit: str
    lower: float  # SI
    upper: float  # SI
    logarithmic: bool
    justification: str  # reason for the bounds
    read: Callable[[Scene], float]  # value in a scene (SI), 0 for a change (``alignment``)

    def value(self, share: float) -> float:
        """Value at ``share`` (0..1) of the way from lower to upper bound."""
        if self.logarithmic:
            return self.lower * (self.upper / self.lower) ** share
        return self.lower + (self.upper - self.lower) * share

    def share(self, value: float) -> float:
        """Inverse of ``value``; outside 0..1 for a value beyond the bounds."""
        if self.logarithmic:
            return math.log(max(value, 1e-300) / self.lower) / math.log(self.upper / self.lower)
        return (value - self.lower) / (self.upper - self.lower)


def free(scene: Scene) -> list[Parameter]:
    """The parameters of the fit of ``scene``: the constants of its contact law, and friction if it
    has any."""
    found = {
        "impact": [_force, _exponent, _damping],
        "hunt-crossley": [_force, _exponent, _dissipation],
        "linear": [_force, _damping],
    }[_contact(scene).law]
    if scene.friction is not None:
        found = [*found, friction]
    return [make(scene) for make in found]


def held(scene: Scene) -> list[Parameter]:
    """Parameters that the fit holds at the scene's value, because they act almost only together
    with a free one."""
    return [_depth(scene)] if isinstance(scene.contact, ImpactTable) else []


def overrides(scene: Scene, values: dict[str, float]) -> dict[str, float]:
    """Dotted overrides (SI) of ``scene`` for values of parameters by name; k is set together with
    e, which is part of its unit."""
    found = {name: value for name, value in values.items() if name in _PLAIN}
    if "contact.force" in values:
        contact = _contact(scene)
        exponent = values.get("contact.exponent", contact.exponent)
        if contact.law != "linear":
            found["contact.exponent"] = exponent
        found["contact.stiffness"] = values["contact.force"] / REFERENCE_PENETRATION**exponent
    if "contact.dissipation" in values:
        found["contact.dissipation"] = values["contact.dissipation"]
    if "contact.damping" in values:
        contact, found["contact.damping"] = _contact(scene), values["contact.damping"]
        if isinstance(contact, ImpactTable):
            depth = values.get("contact.damping_depth", contact.damping_depth)
            found |= {
                "contact.damping": values["contact.damping"] / share_of_damping(depth),
                "contact.damping_depth": depth,
            }
    if "friction.dynamic" in values:
        found |= {
            "friction.dynamic": values["friction.dynamic"],
            "friction.static": values["friction.dynamic"] * _static_over_dynamic(scene),
        }
    return found


def siblings(name: str) -> list[str]:
    """The keys of a scene that the parameter ``name`` sets or replaces."""
    if name == "friction.dynamic":
        return [name, "friction.static"]
    if name in ("contact.clearance_y", "contact.clearance_z"):
        return [name, "contact.clearance"]
    return [name]


def share_of_damping(depth: float) -> float:
    """IMPACT's step s(p_r/d) for a damping depth d (m)."""
    x = min(REFERENCE_PENETRATION / depth, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _stiffness_bounds(scene: Scene) -> tuple[float, float]:
    leg, thickness = scene.rail.leg, scene.rail.thickness
    if leg is None or thickness is None:
        raise SceneError(
            [
                Fault(scene.name, key, "nothing", "a length, with which the bounds of a fit scale")
                for key, length in (("rail.leg", leg), ("rail.thickness", thickness))
                if length is None
            ]
        )
    scale = scene.rail.material.youngs_modulus * thickness**3 / leg**2
    return _SOFT * scale / _MARGIN, _STIFF * scale * _MARGIN


def _contact(scene: Scene) -> ContactTable:
    assert scene.contact is not None  # a fit has something to fit
    return scene.contact


def _friction_of(scene: Scene) -> FrictionTable:
    assert scene.friction is not None
    return scene.friction


def _force(scene: Scene) -> Parameter:
    low, high = _stiffness_bounds(scene)

    def read(scene: Scene) -> float:
        contact = _contact(scene)
        return contact.stiffness * REFERENCE_PENETRATION**contact.exponent

    return Parameter(
        name="contact.force",
        unit="N",
        lower=low * REFERENCE_PENETRATION,
        upper=high * REFERENCE_PENETRATION,
        logarithmic=True,
        justification=f"elastic force at 0.02 mm: secant stiffness between a tenth of the rail's softest static "
        f"stiffness ({low:.3g} N/m) and "
        f"ten times its stiffest ({high:.3g} N/m), estimated from E t^3/a^2; the rail is the "
        f"spring",
        read=read,
    )


def _exponent(scene: Scene) -> Parameter:
    return Parameter(
        name="contact.exponent",
        unit="1",
        lower=1.0,
        upper=2.2,
        logarithmic=False,
        justification="1 for a linear elastic rail, 1.5 for Hertz, up to 2.2 for crowned pads that gain area; "
        "below 1 a contact would be "
        "infinitely stiff at first touch",
        read=lambda s: _contact(s).exponent,
    )


def _damping(scene: Scene) -> Parameter:
    critical = 2.0 * math.sqrt(_stiffness_bounds(scene)[1] / _MARGIN * scene.payload.mass)
    where = (
        "damping coefficient at 0.02 mm (c s(0.02 mm/d), d held)"
        if isinstance(scene.contact, ImpactTable)
        else "damping coefficient"
    )

    def read(scene: Scene) -> float:
        contact = scene.contact
        if isinstance(contact, ImpactTable):
            return contact.damping * share_of_damping(contact.damping_depth)
        assert isinstance(contact, LinearTable)
        return contact.damping

    return Parameter(
        name="contact.damping",
        unit="N*s/m",
        lower=0.0,
        upper=0.2 * critical,
        logarithmic=False,
        justification=f"{where}: from none to a fifth of critical, 2 sqrt(k m) = {critical:.3g} N s/m of the "
        f"payload on the rail's stiffest "
        "place, where restitution is 0.5: metal does not lose more in one touch at millimetres per "
        "second",
        read=read,
    )


def _dissipation(scene: Scene) -> Parameter:
    def read(scene: Scene) -> float:
        assert isinstance(scene.contact, HuntCrossleyTable)
        return scene.contact.dissipation

    return Parameter(
        name="contact.dissipation",
        unit="s/m",
        lower=0.1,
        upper=100.0,
        logarithmic=True,
        justification="restitution between 0.999 and 0.4 at an approach of 20 mm/s, the speed a clearance lets a "
        "pad gain "
        "(1 - 2 a v/3 at low speed)",
        read=read,
    )


def friction(scene: Scene) -> Parameter:
    """The coefficient of friction of a scene that has it."""
    return Parameter(
        name="friction.dynamic",
        unit="1",
        lower=0.05,
        upper=0.5,
        logarithmic=False,
        justification="coated or lubricated (0.05) to clean dry aluminium under light load (0.5); static moves "
        "with dynamic in the scene's "
        "ratio, because a pad at metres per second never sticks",
        read=lambda s: _friction_of(s).dynamic,
    )


def _depth(scene: Scene) -> Parameter:
    def read(scene: Scene) -> float:
        assert isinstance(scene.contact, ImpactTable)
        return scene.contact.damping_depth

    return Parameter(
        name="contact.damping_depth",
        unit="m",
        lower=3e-5,
        upper=3e-3,
        logarithmic=True,
        justification="from just above the penetrations that occur to ten times the deepest depth in use",
        read=read,
    )


def _static_over_dynamic(scene: Scene) -> float:
    friction = _friction_of(scene)
    return friction.static / friction.dynamic if friction.dynamic > 0.0 else 1.0
