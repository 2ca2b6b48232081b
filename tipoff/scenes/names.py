"""Names of scenes and conditions. They name result files, so each must be a valid file name on
every system."""

import re
from collections.abc import Iterable
from typing import Any

EXPECTED = 'at most 64 letters a-z, A-Z, digits, "-", "_" and ".", the first a letter or digit'
NOMINAL = "nominal"  # the scene itself, named like a condition
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def of_scene(name: str) -> str:
    """``name``, if it is valid for a scene. Raises ValueError with what is expected."""
    if not _NAME.fullmatch(name):
        raise ValueError(
            f"{EXPECTED}; a scene file without this key is called by the name of the file"
        )
    return name


def faults(conditions: Iterable[Any]) -> list[tuple[str, str, str]]:
    """Faults (key, given, expected) of the names of ``conditions``: each must be valid, not
    that of the scene itself, and differ from the others in more than upper and lower case."""
    found: list[tuple[str, str, str]] = []
    seen: dict[str, str] = {}
    for name in conditions:
        if not (isinstance(name, str) and _NAME.fullmatch(name)):
            found.append(("conditions", repr(name), EXPECTED))
        elif name.lower() == NOMINAL:
            expected = "another name: this one is of the scene itself, without a condition"
            found.append(("conditions", repr(name), expected))
        elif (other := seen.setdefault(name.lower(), name)) != name:
            found.append(
                (
                    "conditions",
                    repr(name),
                    f"a name that differs from {other!r} in more than upper and lower case",
                )
            )
    return found
