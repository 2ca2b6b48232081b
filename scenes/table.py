"""Base of every table of a scene file: frozen, strict about unknown keys, never silently default on a misspelling."""

from pydantic import BaseModel, ConfigDict


class Table(BaseModel):
    """One table of a scene; fields are SI floats after validation."""

    model_config = ConfigDict(frozen=True, extra="forbid")
