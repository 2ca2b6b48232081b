"""Base of every table of a scene file: frozen, strict about unknown keys, never silently default on
a misspelling."""

from collections.abc import Sized
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationInfo, model_validator


class Table(BaseModel):
    """One table of a scene; fields are SI floats after validation.

    A table that is written but empty is refused: its presence would switch something on that has no
    value.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _not_empty(cls, data: Any, info: ValidationInfo) -> Any:
        # Only input is judged (it comes with a context), not the defaults that the program makes
        # itself. A table with required keys is left to the list of what is missing.
        optional = not any(field.is_required() for field in cls.model_fields.values())
        if data == {} and optional and info.context is not None:
            raise ValueError("at least one key, or no such table")
        return data


def is_absent(value: Any) -> bool:
    """Keeps a key that came later out of what is written where it is not used, so that older scenes
    keep their hash."""
    return value is None


def at_least_one(items: Sized) -> Sized:
    """Pydantic validator of a list that may not be empty; its own min_length also counts items that
    are refused."""
    if len(items) == 0:
        raise ValueError("at least one of them")
    return items
