"""The common part of all stages: options, key, result file.

A stage of a study is written like this:

    @dataclass(frozen=True)
    class Heavier:
        mass_kg: float
        rows: tuple[Row, ...]  # Row is another dataclass

    def run(study: Study, options: HeavierOptions = HeavierOptions()) -> Made[Heavier]:
        def make() -> tuple[Heavier, list[Path]]:
            ...
            return Heavier(mass, rows), files  # and what was written

        return STAGE.run(study, options, make)

    STAGE = Stage("heavier", __name__, HeavierOptions, result=Heavier)

``run`` returns a ``Made`` with ``Heavier`` as its ``result``. Each tuple of dataclasses is also
written as a CSV file. ``STAGE.stored(study)`` finds a result of the present scene, code and settings,
with any options. ``studies/ablation`` is an example, ``studies/limits`` one with further ``inputs``.
"""

import csv
import dataclasses
import functools
import io
import typing
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic import TypeAdapter

from tipoff import sources
from tipoff.files import content_hash, write_text
from tipoff.workspace import options as rules
from tipoff.workspace.study import Study

_AXES = ("x", "y", "z")
_MOST = 12  # numbers that may stand in one row; more are a curve
_Result = TypeVar("_Result")


class Made(NamedTuple, Generic[_Result]):
    """A ``result``, and the ``document`` of its file: the result as JSON values with its options, key
    and files."""

    result: _Result
    document: dict

    @property
    def key(self) -> str:
        """Digest of everything that determines the result."""
        return self.document["key"]

    @property
    def took(self) -> dict:
        """``wall_s`` and number of ``runs`` when the result was made; empty where not known."""
        return self.document.get("took", {})

    @property
    def state(self) -> dict | None:
        """``machine.state`` when the result was made; None where not known."""
        return self.document.get("state")


def _nothing(study: Study, options: Any) -> None:
    return None


@dataclass(frozen=True)
class Stage(Generic[_Result]):
    """One stage."""

    name: str  # of the result file
    module: str  # ``__name__`` of the module whose code and imports make the result
    # type: a frozen dataclass of JSON values, paths, tuples and other such dataclasses; None
    # without options
    options: Any = None
    # Returns the further inputs of the result as JSON values. It may raise SceneError, OSError,
    # KeyError, TypeError or ValueError if there are none.
    inputs: Callable[[Study, Any], Any] = _nothing
    field: str = "asked"  # key of the options in the result
    result: type[_Result] | None = None  # a frozen dataclass; None for JSON values without one
    of_scene: bool = True  # whether the result depends on the scene and the settings

    def plain(self, options: Any) -> Any:
        """``options`` as JSON values."""
        return _adapter(self.options).dump_python(options, mode="json")

    def key(self, study: Study, options: Any) -> str:
        """Digest of everything that determines the result."""
        if not self.of_scene:
            return content_hash(self.name, self.plain(options), sources.digest(self.module))
        inputs = self.inputs(study, options)
        return study.key(self.module, self.name, self.plain(options), inputs)

    def run(
        self, study: Study, options: Any, make: Callable[[], tuple[_Result, list[Path]]]
    ) -> Made[_Result]:
        """The stored result if nothing changed, else that of ``make``, which returns the result and the
        files that it wrote. A result without a type must contain ``plain(options)`` under
        ``field``. Raises SceneError if an option breaks its rule."""
        if dataclasses.is_dataclass(options):
            rules.require(options)

        def document() -> tuple[dict, list[Path]]:
            found, files = make()
            if self.result is None:
                return found, files  # type: ignore[return-value]
            plain = self.content(found)
            asked = {} if self.options is None else {self.field: self.plain(options)}
            return asked | plain, [*files, *self._tables(study, plain)]

        return self.made(study.stage(self.name, self.key(study, options), document))

    def read(self, document: dict) -> _Result:
        """The result in the ``document`` of a file. Raises ValueError if it is missing."""
        return document if self.result is None else _adapter(self.result).validate_python(document)  # type: ignore[return-value]

    def made(self, document: dict) -> Made[_Result]:
        """The result of a file with its ``document``. Raises ValueError if it is missing."""
        return Made(self.read(document), document)

    def content(self, result: _Result) -> dict:
        """A ``result`` as JSON values."""
        return _adapter(self.result).dump_python(result, mode="json", by_alias=True)

    def asked(self, document: dict) -> Any:
        """The options of a stored result. Raises ValueError if they are not valid now."""
        return _adapter(self.options).validate_python(document.get(self.field))

    def stored(self, study: Study) -> Made[_Result] | None:
        """The stored result if it was made from the present scene, code and settings, else None."""

        def key(document: dict) -> str:
            return self.key(study, self.asked(document))

        found = study.stored(self.name, key)
        return None if found is None else self.made(found)

    def schema(self) -> dict:
        """JSON schema of the result."""
        return _adapter(self.result).json_schema(mode="serialization")

    def _tables(self, study: Study, plain: dict) -> Iterator[Path]:
        """Write each table of a result as CSV."""
        for name, hint in typing.get_type_hints(self.result).items():
            of, *_ = *typing.get_args(hint), None
            if typing.get_origin(hint) is tuple and dataclasses.is_dataclass(of):
                path = study.path(f"{self.name}{'' if name == 'rows' else f'_{name}'}.csv")
                write_text(path, csv_of(plain[name]))
                yield path


def csv_of(rows: list[dict]) -> str:
    """JSON ``rows`` as CSV: keys as heads, several numbers in several columns, a list of words in one
    column, an empty cell for a missing value. A record in a row has its own columns. Curves and
    matrices are left out."""
    rows = _flat(rows)
    columns = {
        name: [row.get(name) for row in rows]
        for name in dict.fromkeys(key for row in rows for key in row)
    }
    wide = {
        name: max(map(len, map(_numbers, values)), default=0)
        for name, values in columns.items()
        if not any(map(_is_long, values))
    }
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(head for name, count in wide.items() for head in _heads(name, count))
    for row in rows:
        table.writerow(
            cell for name, count in wide.items() for cell in _cells(row.get(name), count)
        )
    return stream.getvalue()


def _cells(value: Any, count: int) -> list:
    """A value in the columns of ``count`` numbers, or in one."""
    numbers = _numbers(value)
    if not numbers:
        return [_text(value)] * max(count, 1)
    return [*numbers, *[""] * (count - len(numbers))]


def _flat(rows: list[dict]) -> list[dict]:
    """The rows with the items of records in them beside the others, under the name of both."""
    records = {name for row in rows for name, value in row.items() if isinstance(value, dict)}
    if not records:
        return rows
    parts = [
        [
            (f"{name}_", value or {}) if name in records else ("", {name: value})
            for name, value in row.items()
        ]
        for row in rows
    ]
    return _flat(
        [{start + key: item for start, part in row for key, item in part.items()} for row in parts]
    )


def _is_long(value: Any) -> bool:
    """Whether a value is no cell: a matrix, records, or a curve."""
    return isinstance(value, list) and (
        any(isinstance(item, (list, dict)) for item in value) or len(_numbers(value)) > _MOST
    )


def _heads(name: str, count: int) -> list[str]:
    if not count:
        return [name]
    ends = _AXES if count == len(_AXES) else map(str, range(1, count + 1))
    return [f"{name}_{end}" for end in ends]


def _numbers(value: Any) -> list:
    """Several numbers; empty for anything else."""
    is_list = isinstance(value, list) and bool(value)
    return (
        value if is_list and not any(isinstance(item, (str, list, dict)) for item in value) else []
    )


def _text(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(map(str, value))
    return "" if value is None else str(value)


_adapter: Callable[[Any], TypeAdapter] = functools.cache(TypeAdapter)
