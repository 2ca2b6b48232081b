"""Faults of input. All of them are reported at once, each with file, key, given and expected
value."""

import difflib
import re
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple


class Fault(NamedTuple):
    """One wrong field: file or option, dotted key, given value, expected value.

    Example:
        >>> try:
        ...     tipoff.load("tiny").replace({"payload.mass": "9 m"})
        ... except tipoff.SceneError as error:
        ...     print(error.faults[0].key, error.faults[0].given)
        payload.mass '9 m'
    """

    source: str
    key: str
    given: str
    expected: str

    @property
    def place(self) -> str:
        """Place of the fault: "options" and arguments of a command, "files", or the "scene"."""
        if self.source.startswith("--") or self.source.isupper():
            return "options"
        return "files" if self.key in ("file", "vary") else "scene"

    def __str__(self) -> str:
        if self.expected.startswith(NO_SUCH_KEY):
            return f"{self.source}: {self.key}: {self.expected}"
        return f"{self.source}: {self.key}: given {self.given}, expected {self.expected}"


NO_SUCH_KEY = "no such key"
MOST_NAMES = 3  # proposed in a message
MOST_ALIKE = 3  # faults of one kind listed in a message
MOST_LINES = 40  # of a message
_NAMED = re.compile(r"^(conditions|provenance|rail\.(?:surfaces|groups))\.[^.]+")  # by the user
_NUMBERS = re.compile(r"[+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?")
_ALIKE = 0.7  # of difflib: one or two letters in ten differ


def close(name: str, known: Iterable[str]) -> str:
    """The ``known`` names that are similar to ``name``, as the end of a message; empty without
    any."""
    others = dict.fromkeys(
        word for word in known if word != name
    )  # a header may name columns twice
    found = difflib.get_close_matches(name, list(others), MOST_NAMES, _ALIKE)
    return f", did you mean {' or '.join(found)}?" if found else ""


def kind_of(given: object) -> str:
    """Text on the kind of an argument."""
    name = type(given).__name__
    return "None" if given is None else f"{'an' if name[0] in 'aeiouAEIO' else 'a'} {name}"


class InputError(ValueError):
    """Input that cannot be used: a scene, a mesh, a step or curves."""


class SceneError(InputError):
    """A scene that cannot be used; ``faults`` lists everything wrong with it.

    Example:
        >>> tipoff.load("tinny")
        Traceback (most recent call last):
        ...
        tipoff.faults.SceneError: 1 fault in the scene
        ...
    """

    def __init__(self, faults: list[Fault]):
        self.faults = faults
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        places = {fault.place for fault in faults}
        place = places.pop() if len(places) == 1 else "input"
        super().__init__(
            "\n".join([f"{count} in the {place}"] + [f"  {line}" for line in listed(faults)])
        )

    def __reduce__(self):
        # From another process; by default the message would be taken as the faults.
        return type(self), (self.faults,)


def listed(faults: list[Fault]) -> list[str]:
    """The faults as lines: ``MOST_ALIKE`` of each kind and the number of further ones; at most
    ``MOST_LINES``. Faults of one kind have the same source; keys and expected values differ only in
    numbers and in names of the user."""
    kinds: dict[tuple[str, ...], list[Fault]] = {}
    for fault in faults:
        key = _NAMED.sub(r"\1.#", fault.key)
        kind = tuple(_NUMBERS.sub("#", part) for part in (fault.source, key, fault.expected))
        kinds.setdefault(kind, []).append(fault)
    found: list[str] = []
    for alike in kinds.values():
        found += map(str, alike[:MOST_ALIKE])
        if more := len(alike) - MOST_ALIKE:
            found += [f"{alike[0].source}: and {more:,} more of this kind"] if more > 0 else []
    if (left := len(found) - MOST_LINES) > 1:
        found[MOST_LINES:] = [f"and {left:,} more lines of other kinds"]
    return found


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
