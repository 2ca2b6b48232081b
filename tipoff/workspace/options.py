"""Options of a study: a frozen dataclass that declares each of them once.

    @dataclass(frozen=True)
    class Options:
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
    """Allowed numbers of an option. None means not given."""

    holds: Callable[[float], bool]
    words: str  # the same as text

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> Any:
        from pydantic_core import core_schema  # slow to load

        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def _checked(self, value: float | None) -> float | None:
        if value is not None and not self.holds(value):
            raise ValueError(self.words)
        return value


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
    """Raise SceneError with a fault for each of the ``options`` that breaks its rule."""
    from pydantic import TypeAdapter, ValidationError  # slow to load, as the scenes are

    from tipoff.scenes.faults import SceneError, faults_of

    try:
        TypeAdapter(type(options)).validate_python(dataclasses.asdict(options))
    except ValidationError as error:
        names = dict(_flags(type(options)))
        raise SceneError(
            [
                fault._replace(source=names.get(fault.key, fault.key), key="value")
                for fault in faults_of(error, "")
            ]
        ) from None


def _flags(kind: type, prefix: str = "") -> typing.Iterator[tuple[str, str]]:
    """(dotted name, flag of the command) of each option of ``kind``."""
    for name, hint in typing.get_type_hints(kind, include_extras=True).items():
        if dataclasses.is_dataclass(hint):
            assert isinstance(hint, type)
            yield from _flags(hint, f"{prefix}{name}.")
        else:
            yield prefix + name, flag(name, hint)


def flag(name: str, hint: Any) -> str:
    """The flag of the option ``name`` with the type ``hint``."""
    notes = [note for note in getattr(hint, "__metadata__", ()) if hasattr(note, "param_decls")]
    for note in notes:
        # the first argument of typer.Option is a default if it is not in Annotated
        for declared in (note.default, *(note.param_decls or ())):
            if isinstance(declared, str) and declared.startswith("--"):
                return declared.partition("/")[0]
    return "--" + name.rstrip("_").replace("_", "-")
