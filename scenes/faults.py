"""Bad input is reported at once and whole: every fault with file, key, what was given and what is expected."""

from typing import Any, NamedTuple

from pydantic import ValidationError


class Fault(NamedTuple):
    """One wrong field."""

    source: str
    key: str
    given: str
    expected: str

    def __str__(self) -> str:
        return f"{self.source}: {self.key}: given {self.given}, expected {self.expected}"


class SceneError(ValueError):
    """A scene that cannot be used; ``faults`` lists everything wrong with it."""

    def __init__(self, faults: list[Fault]):
        self.faults = faults
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        super().__init__("\n".join([f"{count} in the scene"] + [f"  {fault}" for fault in faults]))


_UNION_TAGS = {"impact", "hunt-crossley", "linear", "gaussian", "gaussians", "constant", "measured"}


def _key(location: tuple) -> str:
    return ".".join(str(part) for part in location if part not in _UNION_TAGS) or "scene"


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        return "a table with " + (", ".join(map(str, value)) or "no keys")
    return repr(value)


def _expected(error: dict) -> str:
    kind, message = error["type"], error["msg"]
    if kind == "extra_forbidden":
        return "no such key"
    if kind == "missing":
        return "this key"
    if kind == "value_error":
        return str(error["ctx"]["error"])
    return message.removeprefix("Input should be ")


def faults_of(error: ValidationError, source: str) -> list[Fault]:
    """Every fault in a pydantic error, in the order of the tables."""
    faults = []
    for item in error.errors():
        given = "nothing" if item["type"] == "missing" else _shown(item["input"])
        faults.append(Fault(source, _key(item["loc"]), given, _expected(item)))
    return faults
