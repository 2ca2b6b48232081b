"""What the program has to know of an effect besides its table and its law."""

from typing import Any, NamedTuple


class Effect(NamedTuple):
    """An entry of ``registry.EFFECTS``.

    ``key`` is the dotted key of the effect's table in a scene. ``example`` holds small overrides
    that add the effect to a scene; None where the values depend on the scene. The table of
    an effect that ``is_body_force`` has a method ``body_force`` (``effects.body_force``).
    """

    key: str
    example: dict[str, Any] | None = None
    is_body_force: bool = False
