"""The commands that take a scene: each declares its own options, and gets the common ones as a
``Request``."""

import inspect
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tipoff.studies.commands.options import (
    ElementSize,
    Json,
    Out,
    SceneName,
    Set,
    Strict,
    Workers,
)
from tipoff.studies.commands.running import Output, guarded, study_of

if TYPE_CHECKING:
    from tipoff.workspace.study import Study


@dataclass(frozen=True)
class Request:
    """The common options of a command as they were given."""

    scene: SceneName = "reference"
    out: Out = Path("out")
    set_: Set = None
    element_size: ElementSize = None
    workers: Workers = None
    json_: Json = False
    strict: Strict = False

    def study(
        self,
        conditions: Sequence[str] | None = None,
        overrides: Sequence[str] = (),
        **settings: Any,
    ) -> "Study":
        """The study of the scene, restricted to ``conditions``; ``overrides`` "KEY=VALUE" follow
        those of --set, and ``settings`` are further arguments of ``study_of``. Raises SceneError."""
        return study_of(
            self.scene,
            self.out,
            [*(self.set_ or ()), *overrides],
            conditions,
            self.element_size,
            self.workers,
            strict=self.strict,
            **settings,
        )

    def require_the_scene_as_it_is(self) -> None:
        """Raise SceneError, every fault listed, for options that change the scene or its elements: a
        result that does not depend on these would ignore them."""
        from tipoff.faults import Fault, SceneError

        given = {"--set": self.set_, "--element-size": self.element_size}
        expected = "none: the cases of this command have scenes and elements of their own"
        faults = [
            Fault(option, "option", str(value), expected)
            for option, value in given.items()
            if value
        ]
        if faults:
            raise SceneError(faults)


_COMMON = inspect.signature(Request).parameters


def scene_command(
    without: Collection[str] = (),
) -> Callable[[Callable[..., Output]], Callable[..., None]]:
    """Decorator: a command from a function of a request and its own options that returns the output.

    The help lists own options after --set, and keyword-only ones after --workers. ``without``:
    "element_size" or "workers" if the command does not have this option.
    """
    common = {name: option for name, option in _COMMON.items() if name not in without}

    def decorated(function: Callable[..., Output]) -> Callable[..., None]:
        @wraps(function)
        def command(**given: Any) -> None:
            request = Request(**{name: given.pop(name) for name in common})
            guarded(lambda: function(request, **given), request.json_)

        _, *own = inspect.signature(function).parameters.values()
        options = [
            *(common[name] for name in ("scene", "out", "set_")),
            *(option for option in own if option.kind is not Parameter.KEYWORD_ONLY),
            *(common[name] for name in ("element_size", "workers") if name in common),
            *(option for option in own if option.kind is Parameter.KEYWORD_ONLY),
            *(common[name] for name in ("json_", "strict")),
        ]
        command.__annotations__ = {option.name: option.annotation for option in options}
        command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [option.replace(kind=Parameter.KEYWORD_ONLY) for option in options]
        )
        return command

    return decorated
