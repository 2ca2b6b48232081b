"""The command of a study from the dataclass of its options."""

import dataclasses
import inspect
import types
import typing
from collections.abc import Callable, Collection, Iterator
from inspect import Parameter
from typing import Annotated, Any

from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output


def command(
    name: str,
    text: str,
    options: type | None,
    answer: Callable[[Request, Any], Output],
    without: Collection[str] = (),
) -> Callable[..., None]:
    """The command ``name`` with the help ``text`` and a parameter for each field of ``options``, a
    frozen dataclass or None; ``answer`` gets the request and the options. Fields of ``kw_only``
    come last in the help; the common options in ``without`` are left out. The attribute ``options``
    of the command is the dataclass."""

    def function(request: Request, **given: Any) -> Output:
        return answer(request, options and _made(options, given))

    own = [] if options is None else list(_parameters(options))
    request = Parameter("request", Parameter.POSITIONAL_OR_KEYWORD)
    own.sort(key=lambda option: option.kind)
    function.__signature__ = inspect.Signature([request, *own])  # type: ignore[attr-defined]
    function.__name__, function.__doc__ = name, text
    made = scene_command(without)(function)
    made.options = options  # type: ignore[attr-defined]
    return made


def _fields(options: type) -> Iterator[tuple[dataclasses.Field, Any]]:
    hints = typing.get_type_hints(options, include_extras=True)
    return ((field, hints[field.name]) for field in dataclasses.fields(options))


def _parameters(options: type) -> Iterator[Parameter]:
    for field, hint in _fields(options):
        if dataclasses.is_dataclass(hint):
            assert isinstance(hint, type)
            yield from _parameters(hint)
            continue
        kind = Parameter.KEYWORD_ONLY if field.kw_only else Parameter.POSITIONAL_OR_KEYWORD
        # a list that was not given has the default of the field
        default = None if isinstance(field.default, tuple) else field.default
        yield Parameter(field.name, kind, default=default, annotation=_typed(hint))


def _typed(hint: Any) -> Any:
    """The type of a field as typer takes it: a list for a tuple, and no rules."""
    match typing.get_origin(hint), typing.get_args(hint):
        case origin, (inner, *notes) if origin is Annotated:
            kept = [note for note in notes if hasattr(note, "param_decls")]
            return Annotated[(_typed(inner), *kept)]
        case origin, (inner, types.NoneType) if origin in (typing.Union, types.UnionType):
            return _typed(inner) | None
        case origin, (inner, end) if origin is tuple and end is Ellipsis:
            return list[inner] | None  # type: ignore[valid-type]
    return hint


def _made(options: type, given: dict[str, Any]) -> Any:
    """The options as they were ``given`` by name."""
    values = {}
    for field, hint in _fields(options):
        if dataclasses.is_dataclass(hint):
            assert isinstance(hint, type)
            values[field.name] = _made(hint, given)
        elif isinstance(value := given[field.name], list):
            values[field.name] = tuple(value)
        elif value is not None:
            values[field.name] = value
    return options(**values)
