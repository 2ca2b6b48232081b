"""The names that ``import tipoff`` offers and ``docs/reference/python.md`` lists, with their parameters, are
those of ``public_names.txt``.

A difference is a change for users. CONTRIBUTING.md says what may change in 1.x. Write the change into
CHANGELOG.md, then write the list again: ``python -m tests.test_public_names``.
"""

import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import tipoff

LIST = Path(__file__).with_name("public_names.txt")
PAGE = LIST.parents[1] / "docs" / "reference" / "python.md"
_ENTRY = re.compile(
    r"^\.\. auto(?:function|class|exception):: tipoff\.(\S+)\n(?:   :members: (.*)\n)?", re.M
)


def listed() -> str:
    """A line for each name of the page and for each member of its classes."""
    return "\n".join(lines()) + "\n"


def lines() -> Iterator[str]:
    for name, members in _ENTRY.findall(PAGE.read_text(encoding="utf-8")):
        of = found(name)
        yield name if inspect.isclass(of) else f"{name}{parameters(of)}"
        for member in filter(None, members.split(", ")):
            yield f"{name}.{member}{of_member(of, member)}"


def found(name: str) -> object:
    """What a dotted name of the package is."""
    package, _, last = f"tipoff.{name}".rpartition(".")
    return getattr(importlib.import_module(package), last)


def of_member(of: type, name: str) -> str:
    """The parameters of a method; nothing for a value. Raises LookupError for a name that is not there."""
    value = getattr(of, name, None)
    if inspect.isroutine(value):
        return parameters(value)
    fields = getattr(of, "__annotations__", {}) | getattr(of, "model_fields", {})
    if value is None and name not in fields:
        raise LookupError(f"{of.__name__} has no {name}")
    return ""


def parameters(of: object) -> str:
    """Names and defaults; an annotation may become wider."""
    each = inspect.signature(of).parameters.values()
    return str(inspect.Signature([one.replace(annotation=one.empty) for one in each]))


def test_public_names_are_those_of_the_list():
    kept, now = LIST.read_text(encoding="utf-8").splitlines(), listed().splitlines()
    gone, new = (
        [line for line in kept if line not in now],
        [line for line in now if line not in kept],
    )
    assert (gone, new) == ([], []), (
        f"gone: {gone}, new: {new}. Write this into CHANGELOG.md, and the list by "
        f"`python -m tests.test_public_names`"
    )


def test_the_page_lists_every_name_of_the_package():
    names = {line.partition("(")[0] for line in listed().splitlines()}
    assert set(tipoff.__all__) <= names
    assert "highfi.Numerics.step" in names and "Trajectory.rate" in names


if __name__ == "__main__":
    LIST.write_text(listed(), encoding="utf-8")
