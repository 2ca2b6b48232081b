"""The common part of all stages: options, key, result file.

A stage of a study is written like this:

    @dataclass(frozen=True)
    class Options:
        cases: int = 100

    def run(study: Study, options: Options = Options()) -> dict:
        ...  # check the options; SceneError for bad input

        def make() -> tuple[dict, list[Path]]:
            ...
            return {"asked": STAGE.plain(options), ...}, files  # JSON values, and what was written

        return STAGE.run(study, options, make)

    STAGE = Stage("name", __name__, Options)

``STAGE.stored(study)`` finds a result of the present scene, code and settings, with any options.
``studies/limits`` is an example, with further ``inputs``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from tipoff.workspace.study import Study


def _nothing(study: Study, options: Any) -> None:
    return None


@dataclass(frozen=True)
class Stage:
    """One stage.

    ``name``: of the result file. ``module``: the module (``__name__``) whose code, with all that it
    imports, makes the result. ``options``: their type, a frozen dataclass of JSON values, paths,
    tuples and other such dataclasses; None without options. ``inputs``: makes the further inputs of
    the result, as JSON values; it may raise SceneError, OSError, KeyError, TypeError or ValueError
    where there are none. ``field``: the key of the options in the result.
    """

    name: str
    module: str
    options: Any = None
    inputs: Callable[[Study, Any], Any] = _nothing
    field: str = "asked"

    def plain(self, options: Any) -> Any:
        """``options`` as JSON values."""
        return TypeAdapter(self.options).dump_python(options, mode="json")

    def key(self, study: Study, options: Any) -> str:
        """Digest of everything that the result depends on."""
        inputs = self.inputs(study, options)
        return study.key(self.module, self.name, self.plain(options), inputs)

    def run(self, study: Study, options: Any, make: Callable[[], tuple[dict, list[Path]]]) -> dict:
        """The stored result where nothing changed, else the result of ``make``, which returns it
        with the files that it wrote. It must contain ``plain(options)`` under ``field``."""
        return study.stage(self.name, self.key(study, options), make)

    def asked(self, found: dict) -> Any:
        """The options of a stored result. Raises ValueError where they are invalid now."""
        return TypeAdapter(self.options).validate_python(found.get(self.field))

    def stored(self, study: Study) -> dict | None:
        """The stored result if it was made from the present scene, code and settings, else None."""

        def key(found: dict) -> str:
            return self.key(study, self.asked(found))

        return study.stored(self.name, key)
