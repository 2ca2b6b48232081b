"""Fields of a record that are found at their first use."""

from collections.abc import Callable
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Self


class Completed:
    """Base of a dataclass whose fields ``PUT_OFF`` may come later. They have no plain default, which
    would hide that they are missing."""

    PUT_OFF: ClassVar[tuple[str, ...]] = ()

    def completed_by(self, complete: Callable[[], Self], *names: str) -> Self:
        """A copy with the fields ``names``, of ``PUT_OFF``, of ``complete()``, which is called when one
        of them is first used."""
        copy = object.__new__(type(self))
        later = {**vars(self).get("_later", {}), **dict.fromkeys(names, complete)}
        vars(copy).update(vars(self), _later=later)
        for name in names:
            vars(copy).pop(name, None)
        return copy

    if not TYPE_CHECKING:  # an attribute that does not exist stays a fault

        def __getattr__(self, name: str) -> Any:
            own = vars(self)
            complete = own.get("_later", {}).get(name)
            if complete is None or name not in type(self).PUT_OFF:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            whole = complete()
            own.update(
                {each: getattr(whole, each) for each, of in own["_later"].items() if of is complete}
            )
            return own[name]

    def __getstate__(self) -> dict[str, Any]:
        # complete: what completes it may hold megabytes
        return {item.name: getattr(self, item.name) for item in fields(self)}  # type: ignore[arg-type]
