"""Fields of a record that are found at their first use."""

from collections.abc import Callable
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Self


class Completed:
    """Base of a dataclass whose fields ``PUT_OFF`` may come later. They have no plain default, which
    would hide that they are missing."""

    PUT_OFF: ClassVar[tuple[str, ...]] = ()

    def completed_by(self, complete: Callable[[], Self]) -> Self:
        """A copy with the fields ``PUT_OFF`` of ``complete()``, which is called when one of them is
        first used."""
        copy = object.__new__(type(self))
        vars(copy).update(vars(self), _complete=complete)
        for name in self.PUT_OFF:
            del vars(copy)[name]
        return copy

    if not TYPE_CHECKING:  # an attribute that does not exist stays a fault

        def __getattr__(self, name: str) -> Any:
            own = vars(self)
            if name in type(self).PUT_OFF and "_complete" in own:
                whole = own["_complete"]()
                own.update({each: getattr(whole, each) for each in self.PUT_OFF})
                return own[name]
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __getstate__(self) -> dict[str, Any]:
        # complete: what completes it may hold megabytes
        return {item.name: getattr(self, item.name) for item in fields(self)}  # type: ignore[arg-type]
