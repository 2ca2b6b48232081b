"""The values of a scene that the page has sliders for: their keys, units and ranges."""

import math
from collections.abc import Mapping
from operator import attrgetter
from typing import NamedTuple

from tipoff import Scene


class Control(NamedTuple):
    """A slider under the heading ``group``: dotted ``key`` of the scene, ``unit`` of its numbers, ``si``
    value of one unit, and ``high`` end and ``step`` in that unit. The low end is zero."""

    group: str
    title: str
    key: str
    unit: str
    si: float
    high: float
    step: float

    @property
    def is_angle_around(self) -> bool:
        """Whether it is a clock angle, which repeats after a full turn."""
        return self.high == 360.0

    @property
    def label(self) -> str:
        """Title and unit."""
        return f"{self.title} ({self.unit})" if self.unit else self.title


def _errors(group: str, table: str, size: tuple, way: str) -> tuple[Control, Control]:
    """Size and clock angle of one error."""
    turn = (f"clock angle, {way}", f"{table}.radial", "deg", math.radians(1.0), 360.0, 1.0)
    return Control(group, size[0], f"{table}.axial", *size[1:]), Control(group, *turn)


_TILT = ("angle off the axis", "deg", math.radians(1.0), 1.0, 0.01)
_RADIUS = ("distance from the axis", "mm", 1e-3, 1.0, 0.01)
CONTROLS = (
    *_errors("Thrust misalignment", "thrust_offset.misalignment", _TILT, "+Y to +Z"),
    *_errors("Thrust eccentricity", "thrust_offset.eccentricity", _RADIUS, "+Z to +Y"),
    *_errors("Mass eccentricity", "mass_offset.eccentricity", _RADIUS, "+Z to +Y"),
    Control("Launcher", "clearance of the pads", "contact.clearance", "mm", 1e-3, 0.5, 0.005),
    Control("Launcher", "friction coefficient", "friction.dynamic", "", 1.0, 0.5, 0.01),
    Control("Launcher", "peak thrust", "thrust.peak", "kN", 1e3, 12.0, 0.1),
)
_NEEDS = ("contact", "friction", "thrust")  # without the table there is nothing to change


def value(scene: Scene, control: Control) -> float | None:
    """The value in ``scene`` in the unit of ``control``: 0 where an offset is absent, None where the
    scene has no such key."""
    head = control.key.partition(".")[0]
    try:
        found = attrgetter(control.key)(scene)
    except AttributeError:  # the table is absent, or of another kind
        return None if head in _NEEDS else 0.0
    if found is None or callable(found):  # a pulse that is given by its impulse; springs
        return None
    # as many digits as stand beside a slider; a value that nobody moves is not taken from here
    return float(f"{found / control.si:.4g}")


def of_scene(scene: Scene) -> dict[Control, float]:
    """The controls that ``scene`` has, with the value at which their slider begins. A range that the
    value is outside of is extended to twice the value."""
    found = {}
    for control in CONTROLS:
        if (start := value(scene, control)) is None:
            continue
        if control.is_angle_around:
            start %= 360.0
        if 0.0 <= start <= control.high:
            found[control] = start
        elif start > 0.0:
            found[control._replace(high=2.0 * start)] = start
    return found


def overrides(scene: Scene, values: Mapping[Control, float]) -> dict[str, float]:
    """Dotted keys (SI) of the ``values`` that differ from those of ``scene``; what nobody moved
    stays as it was written. Static friction keeps its ratio to the dynamic one."""
    begun = of_scene(scene)
    moved = {item: number for item, number in values.items() if number != begun[item]}
    found = {control.key: number * control.si for control, number in moved.items()}
    if (dynamic := found.get("friction.dynamic")) is not None and scene.friction is not None:
        before = scene.friction.dynamic
        ratio = scene.friction.static / before if before else 1.0
        found["friction.static"] = ratio * dynamic
    if "contact.clearance" in found and scene.contact is not None:
        # clearances of single axes would hide the new value
        own = {"clearance_y": scene.contact.clearance_y, "clearance_z": scene.contact.clearance_z}
        found |= {
            f"contact.{name}": found["contact.clearance"]
            for name, gap in own.items()
            if gap is not None
        }
    return found
