"""Base of every table of a scene file: frozen, and an unknown key is a fault."""

from collections.abc import Sized
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, model_validator

MOST = 5000  # of a list or of named tables: pads, mounts, conditions
limited: Any = Field(max_length=MOST)  # of a field with any number of items


class Table(BaseModel):
    """One table of a scene; fields are SI floats after validation.

    An empty table is refused: its presence would switch on an effect without values.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _not_empty(cls, data: Any, info: ValidationInfo) -> Any:
        # Input has a context, a default has none. A table with required keys reports their absence.
        optional = not any(field.is_required() for field in cls.model_fields.values())
        if data == {} and optional and info.context is not None:
            raise ValueError("at least one key, or no such table")
        return data


def is_absent(value: Any) -> bool:
    """Value of ``exclude_if`` for new keys: scenes without them keep their hash."""
    return value is None


def is_one(value: object) -> bool:
    """Whether a factor is left out of a table that is written."""
    return value == 1.0


def is_zero(value: Any) -> bool:
    """Whether a value is zero. A new key whose zero changes nothing is left out of dumps."""
    return value == 0.0


def at_least_one(items: Sized) -> Sized:
    """Pydantic validator of a list that may not be empty. Pydantic's min_length would also report
    lists with refused items."""
    if len(items) == 0:
        raise ValueError("at least one of them")
    return items
