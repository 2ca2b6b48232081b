"""Hold-down: a latch between platform and payload, which holds the travel along the rail until the
thrust first reaches a value, or until a time. Absent table: no latch, but a stop where the weight pulls
the payload back (``mechanics.estimates.stop``).

The latch acts in both directions (``mechanics.laws.hold_down``).
"""

import math

from pydantic import Field, model_validator

from tipoff.faults import Fault, SceneError
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.scenes.effects.effect import Effect
from tipoff.scenes.effects.spring import PushedTable
from tipoff.scenes.table import Table, is_absent
from tipoff.scenes.units import NonNegativeForce, NonNegativeTime

EFFECT = Effect("hold_down")


class HoldDownTable(Table):
    """``[hold_down]``: thrust (N) or time (s) at which the payload is released."""

    #: Thrust at which the payload is released, once for all; 0 is the ignition. With 0 there is no
    #: stop behind the payload either, and its weight may pull it back. Exactly one of release and
    #: release_time.
    release: NonNegativeForce | None = Field(None, exclude_if=is_absent)
    #: Time after ignition at which the payload is released, in place of release.
    release_time: NonNegativeTime | None = Field(None, exclude_if=is_absent)

    @model_validator(mode="after")
    def _one_of_both(self):
        if (self.release is None) == (self.release_time is None):
            raise ValueError("exactly one of release and release_time")
        return self

    @property
    def is_open(self) -> bool:
        """Whether nothing is held from the ignition on, and there is no stop either."""
        return self.release == 0.0 or self.release_time == 0.0


def release_time(scene) -> float:
    """Time (s) at which the latch releases; 0 without one, infinite if the thrust is too small."""
    if scene.hold_down is None or isinstance(scene.thrust, PushedTable):
        return 0.0
    if scene.hold_down.release_time is not None:
        return scene.hold_down.release_time
    return thrust_law.reached(scene.thrust.record(), scene.hold_down.release)


def require(scene) -> None:
    """Raise SceneError for a thrust that never reaches the value, for springs, and for a payload that
    moves along the rail, and for a release after the end of the scene. A release at ignition needs
    nothing."""
    if scene.hold_down is None or scene.hold_down.is_open:
        return
    found, time = [], release_time(scene)
    if isinstance(scene.thrust, PushedTable):
        found.append(("hold_down", "a table", "none: springs push from the ignition on"))
    elif time == math.inf:
        most = f"at most the largest thrust, {thrust_law.peak(scene.thrust.record(), time):.6g} N"
        found.append(("hold_down.release", f"{scene.hold_down.release:g} N", most))
    elif (wanted := scene.hold_down.release_time) and wanted >= (scene.duration or math.inf):
        least = f"less than the duration, {scene.duration:g} s"
        found.append(("hold_down.release_time", f"{wanted:g} s", least))
    first, free = scene.initial, scene.platform is not None
    if first is not None and first.velocity.x != (first.platform_velocity.x if free else 0.0):
        found.append(("initial", "a velocity along the rail", "none: the payload is held"))
    if found:
        raise SceneError([Fault(scene.name, *fault) for fault in found])
