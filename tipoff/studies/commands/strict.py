"""The option ``--strict`` of every command that takes a scene."""

import functools
import inspect
from collections.abc import Callable
from contextvars import ContextVar
from typing import Annotated, Any

import typer

_STRICT = ContextVar("strict", default=False)
Strict = Annotated[
    bool,
    typer.Option("--strict", help="Refuse implausible values of the scene, instead of a warning."),
]


def is_strict() -> bool:
    """Whether the command that runs now was given ``--strict``."""
    return _STRICT.get()


def add_strict(app: typer.Typer) -> None:
    """Give every command of ``app`` that takes a scene this option."""
    for command in app.registered_commands:
        assert command.callback is not None
        if "scene" in inspect.signature(command.callback).parameters:
            command.callback = _with_strict(command.callback)


def _with_strict(function: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(function)
    def command(strict: bool = False, **options: Any) -> Any:
        _STRICT.set(strict)
        return function(**options)

    added = inspect.Parameter(
        "strict", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Strict
    )
    signature = inspect.signature(function)
    parameters = [*signature.parameters.values(), added]
    command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {**function.__annotations__, "strict": Strict}
    return command
