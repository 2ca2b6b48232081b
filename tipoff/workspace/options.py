"""Options of a study: a frozen dataclass that declares each of them once.

    @dataclass(frozen=True)
    class ClearancesOptions:
        cases: Annotated[int, between(100), typer.Option(metavar="N", help="Number of cases.")] = 1000

The command has an option ``--cases``, the result file has ``cases``, and ``require`` checks the
rule. A field with such a dataclass as its type has further options of the same command.
"""

import dataclasses
import typing
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Rule:
    """Allowed numbers of an option. An option that is None is not given, and breaks no rule."""

    holds: Callable[[float], bool]
    words: str  # the same as text


def between(
    least: float | None = None,
    most: float | None = None,
    below: float | None = None,
    noun: str = "",
) -> Rule:
    """Rule for the number of an option: ``least`` to ``most``, or less than ``below``; ``noun``
    names what it counts."""
    words = "" if least is None else f"{least:,g} or more"
    if most is not None:
        words = f"at most {most:,g}" if least is None else f"{least:,g} to {most:,g}"
    if below is not None:
        words += f"{' and ' if words else ''}less than {below:,g}"

    def holds(value: float) -> bool:
        return (
            (least is None or value >= least)
            and (most is None or value <= most)
            and (below is None or value < below)
        )

    return Rule(holds, f"{words} {noun}".rstrip())


def require(options: Any) -> None:
    """Raise SceneError with a fault for each of the ``options`` that has another type or breaks its
    rule."""
    from pydantic import TypeAdapter, ValidationError  # slow to load, as the scenes are

    from tipoff.faults import Fault, SceneError
    from tipoff.scenes.faults import faults_of

    given = [
        (path, flag(path.rpartition(".")[2], hint), hint, value)
        for path, hint, value in _each(options)
    ]
    try:
        TypeAdapter(type(options)).validate_python(dataclasses.asdict(options))
    except ValidationError as error:
        names = {path: name for path, name, *_ in given}
        raise SceneError(
            [
                fault._replace(source=names.get(fault.key, fault.key), key="value")
                for fault in faults_of(error, "")
            ]
        ) from None
    faults = [
        Fault(name, "value", value, rule.words)
        for _, name, hint, value in given
        for rule in rules(hint)
        if value is not None and not rule.holds(value)
    ]
    if faults:
        raise SceneError(faults)


def rules(hint: Any) -> typing.Iterator[Rule]:
    """The rules in the annotations of the type ``hint`` of an option. A ``typer.Option`` with a least
    or a largest number is a rule too."""
    for note in getattr(hint, "__metadata__", ()):
        least, most = getattr(note, "min", None), getattr(note, "max", None)
        if isinstance(note, Rule):
            yield note
        elif least is not None or most is not None:
            yield between(least, most)


def _each(options: Any, prefix: str = "") -> typing.Iterator[tuple[str, Any, Any]]:
    """(dotted name, type, value) of each of the ``options``."""
    for name, hint in typing.get_type_hints(type(options), include_extras=True).items():
        value = getattr(options, name)
        if dataclasses.is_dataclass(value):
            yield from _each(value, f"{prefix}{name}.")
        else:
            yield prefix + name, hint, value


def flag(name: str, hint: Any) -> str:
    """The flag of the option ``name`` with the type ``hint``."""
    notes = [note for note in getattr(hint, "__metadata__", ()) if hasattr(note, "param_decls")]
    for note in notes:
        # the first argument of typer.Option is a default if it is not in Annotated
        for declared in (note.default, *(note.param_decls or ())):
            if isinstance(declared, str) and declared.startswith("--"):
                return declared.partition("/")[0]
    return "--" + name.rstrip("_").replace("_", "-")
