"""Faults that pydantic finds in a table of a scene, as ``tipoff.faults``."""

from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from tipoff.faults import NO_SUCH_KEY, Fault


def within(key: str, given: str, expected: str) -> PydanticCustomError:
    """A fault of ``key``, for a validator of the whole table."""
    return PydanticCustomError(
        "within", "{expected}", {"key": key, "given": given, "expected": expected}
    )


# Pydantic puts the chosen variant into the location: ("thrust", "gaussian", "width") means
# thrust.width.
_VARIANTS = ("thrust", "contact", "friction", "rail")
# variants that are chosen by the presence of a key
_FILED = (("rail", "mesh"), ("rail", "geometry"), ("rail", "section"))
_KINDS = {"file": 1, "points": 1, "shape": 2}  # of rail.section: parts of the location to drop
_RENAMED = {"contact.penalty": "contact.interface_stiffness"}
_WORDS = {
    "extra_forbidden": NO_SUCH_KEY,
    "missing": "this key",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "tuple_type": "a list",
    "list_type": "a list",
    "string_type": "text",
    "bool_parsing": "true or false",
    "bool_type": "true or false",
}


def renamed(key: str) -> str | None:
    """The new name for a dotted ``key`` with a former name; None for other keys."""
    new = _RENAMED.get(key)
    return new and f"the key {new}, with the same value and unit"


def _key(error: ErrorDetails) -> str:
    location = list(error["loc"])
    if location and location[0] in _VARIANTS and len(location) > 1:
        del location[1]
        if location[:2] == ["rail", "section"] and len(location) > 2:
            del location[2 : 2 + _KINDS.get(str(location[2]), 0)]
    if error["type"].startswith("union_tag"):
        location.append(error["ctx"]["discriminator"].strip("'"))
    if error["type"] == "within":
        location.append(error["ctx"]["key"])
    return ".".join(map(str, location)) or "scene"


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        text = "a table with " + (", ".join(map(str, value)) or "no keys")
    else:
        text = repr(value)
    return text if len(text) < 200 else f"{text[:200]} ..."


def _given(error: ErrorDetails) -> str:
    if error["type"] in ("missing", "union_tag_not_found"):
        return "nothing"
    if error["type"] == "union_tag_invalid":
        return repr(error["ctx"]["tag"])
    if error["type"] == "within":
        return error["ctx"]["given"]
    return _shown(error["input"])


def _expected(error: ErrorDetails) -> str:
    kind, message = error["type"], error["msg"]
    if kind == "extra_forbidden" and (instead := renamed(_key(error))):
        return instead
    if kind == "extra_forbidden" and error["loc"][:2] in _FILED:
        return f"no such key with {error['loc'][1]}"
    if kind in _WORDS:
        return _WORDS[kind]
    if kind == "value_error":
        return str(error["ctx"]["error"])
    if kind == "too_long":
        return f"at most {error['ctx']['max_length']} of them"
    if kind == "union_tag_not_found":
        return f"the key {error['ctx']['discriminator']}"
    if kind == "union_tag_invalid":
        return f"one of {error['ctx']['expected_tags']}"
    return message.removeprefix("Input should be ")


def faults_of(error: ValidationError, source: str) -> list[Fault]:
    """Every fault in a pydantic error, in the order of the tables."""
    return [Fault(source, _key(item), _given(item), _expected(item)) for item in error.errors()]
