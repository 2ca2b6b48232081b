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
    Json,
    Out,
    SceneName,
    Set,
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
    workers: Workers = None
    json_: Json = False

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
            self.workers,
            **settings,
        )

    def require_the_scene_as_it_is(self) -> None:
        """Raise SceneError for --set: a result that does not depend on the scene would ignore it."""
        from tipoff.faults import Fault, SceneError

        if self.set_:
            expected = "none: the cases of this command have scenes and elements of their own"
            raise SceneError([Fault("--set", "option", str(self.set_), expected)])


_COMMON = inspect.signature(Request).parameters


def scene_command(
    without: Collection[str] = (),
) -> Callable[[Callable[..., Output]], Callable[..., None]]:
    """Decorator: a command from a function of a request and its own options that returns the output.

    The help lists own options after --set, and keyword-only ones after --workers. ``without``:
    "workers" if the command does not have this option.
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
            *([common["workers"]] if "workers" in common else []),
            *(option for option in own if option.kind is Parameter.KEYWORD_ONLY),
            common["json_"],
        ]
        command.__annotations__ = {option.name: option.annotation for option in options}
        command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [option.replace(kind=Parameter.KEYWORD_ONLY) for option in options]
        )
        return command

    return decorated
