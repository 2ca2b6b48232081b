"""Data of an effect besides its table and its law."""

from typing import Any, NamedTuple


class Effect(NamedTuple):
    """An entry of ``registry.EFFECTS``.

    ``key`` is the dotted key of the effect's table in a scene. ``example`` has small overrides that
    add the effect to a scene, None if the values depend on the scene. An effect with
    ``is_body_force`` has a table with the method ``body_force`` (``mechanics.laws.body_force``).
    """

    key: str
    example: dict[str, Any] | None = None
    is_body_force: bool = False
