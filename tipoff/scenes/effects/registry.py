"""The effects that a scene may have, in the order of result lists.

A new effect is one file in this folder, an entry here and a field of ``Scene``.
"""

from operator import attrgetter

from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.scenes.effects import (
    contact,
    friction,
    gravity,
    hold_down,
    initial,
    mass_offset,
    mount_stiffness,
    platform,
    structural_damping,
    thermal,
    thrust_offset,
)
from tipoff.scenes.effects.effect import Effect

EFFECTS: tuple[Effect, ...] = (
    thrust_offset.EFFECT,
    mass_offset.EFFECT,
    initial.EFFECT,
    contact.EFFECT,
    friction.EFFECT,
    platform.EFFECT,
    gravity.EFFECT,
    thermal.EFFECT,
    structural_damping.EFFECT,
    mount_stiffness.EFFECT,
    hold_down.EFFECT,
)


def body_forces(scene) -> dict[str, BodyForce]:
    """The body forces of ``scene`` by the key of their effect."""
    tables = {e.key: attrgetter(e.key)(scene) for e in EFFECTS if e.is_body_force}
    return {key: table.body_force() for key, table in tables.items() if table is not None}


def body_force(scene) -> BodyForce | None:
    """The sum of the body forces of ``scene``, None without any."""
    forces = body_forces(scene)
    return BodyForce(*map(sum, zip(*forces.values()))) if forces else None
