"""Checks of several inputs whose faults are reported together."""

from collections.abc import Callable
from typing import Any

from tipoff.scenes.faults import Fault, SceneError


def together(*makes: Callable[[], Any]) -> list:
    """The results of all calls, in order. Raises SceneError with the faults of all of them."""
    found: list[Any] = []
    faults: list[Fault] = []
    for make in makes:
        try:
            found.append(make())
        except SceneError as error:
            faults += error.faults
    if faults:
        raise SceneError(faults)
    return found
