"""Arguments of Python callers: scenes, numbers with or without units, tables of cases. Faults are
reported as for files: all at once, each with the name of the argument."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from tipoff import scenes, units
from tipoff.faults import Fault, SceneError, close, kind_of
from tipoff.scenes import overrides, reading, suggestions
from tipoff.scenes.rounding import below
from tipoff.scenes.scene import Scene, load
from tipoff.scenes.units import COARSEST_ELEMENTS, FINEST_ELEMENTS

_T = TypeVar("_T")
_LENGTHS = {"element_size": "m", "step": "s", "speed_floor": "m/s"}  # numerics with a unit


def parse(
    raw: Mapping[str, Any], source: str = "scene", bare_numbers_are_si: bool = False
) -> Scene:
    """Validate a nested mapping, including all its conditions.

    Args:
        raw: tables by name, as TOML has them; with or without the number ``format``.
        source: name of the mapping in messages.
        bare_numbers_are_si: whether numbers without a unit are taken as SI.

    Returns:
        Scene: the scene.

    Raises:
        SceneError: every fault with source, key, given and expected.

    Example:
        >>> tipoff.parse({"name": "mine"})
        Traceback (most recent call last):
        ...
        tipoff.faults.SceneError: 4 faults in the scene
        ...
    """
    return scenes.parse(reading.of_this_format(raw, source), source, bare_numbers_are_si)


def scene_of(given: Any) -> Scene:
    """``given`` itself, or the scene of a name or path. Raises SceneError."""
    if isinstance(given, Scene):
        return given
    if isinstance(given, (str, Path)):
        return load(given)
    expected = "a scene of tipoff.load, or its name or path"
    raise SceneError([Fault("arguments", "scene", kind_of(given), expected)])


def require_none(scene: Scene, model: str, **given: object) -> None:
    """Raise SceneError if an option of another model is ``given``, not None."""
    faults = [
        Fault(
            f"{scene.name}, model {model}", name, "given", "none: it is an option of another model"
        )
        for name, value in given.items()
        if value is not None
    ]
    if faults:
        raise SceneError(faults)


def numerics(kind: Callable[..., _T], given: Mapping[str, Any], other: type, model: str) -> _T:
    """Numerics of a ``kind`` from the options ``given``; ``other`` are those of other models. Text
    and quantities have their units. Raises SceneError with every option that ``model`` does not
    have or that is no number, and ValueError for values out of range."""
    known = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    theirs = {field.name for field in fields(other)}
    values, faults = {}, []
    for name, value in given.items():
        if name not in known:
            expected = (
                "none: it is an option of another model"
                if name in theirs
                else f"one of {', '.join(known)}{close(name, known)}"
            )
            faults.append(Fault(f"model {model}", name, repr(value), expected))
        else:
            try:
                values[name] = _number(name, value)
            except ValueError as fault:
                faults.append(Fault(f"model {model}", name, repr(value), str(fault)))
    if faults:
        raise SceneError(faults)
    return kind(**values)


class Expected(NamedTuple):
    """Allowed values of an argument."""

    is_right: Callable[[Any], bool]  # check
    words: str  # text for messages


def require(expected: Mapping[str, Expected], **given: Any) -> None:
    """Raise SceneError with every argument that does not fit its ``expected`` entry. None means not
    given."""
    faults = [
        Fault("arguments", name, _shown(value), expected[name].words)
        for name, value in given.items()
        if value is not None and not expected[name].is_right(value)
    ]
    if faults:
        raise SceneError(faults)


def whole(least: int, most: int) -> Expected:
    """A whole number between bounds."""

    def is_right(value: Any) -> bool:
        value = plain(value)
        return type(value) is int and least <= value <= most

    return Expected(is_right, f"a whole number from {least} to {most:,}")


PATH = Expected(
    lambda value: isinstance(value, (str, Path)) and str(value) != "" and "\0" not in str(value),
    "the path of a file or folder",
)
FUNCTION = Expected(callable, "a function of the fraction done")
CHOICE = Expected(lambda value: isinstance(plain(value), bool), "True or False")
NAMES = Expected(
    lambda value: (
        isinstance(value, Sequence)
        and not isinstance(value, (str, bytes))
        and all(isinstance(name, str) for name in value)
    ),
    "a list of names",
)


def kind(type_: type, words: str) -> Expected:
    """An object of a class."""
    return Expected(lambda value: isinstance(value, type_), words)


def _shown(value: Any) -> str:
    """Numbers and text unchanged, the class of anything else."""
    is_plain = isinstance(value, (str, float)) or (isinstance(value, int) and abs(value) < 2**62)
    text = repr(value) if is_plain else ""
    return text if 0 < len(text) <= 80 else kind_of(value)


def length(name: str, given: Any) -> float:
    """An element size (m) of the argument ``name``. Raises SceneError."""
    try:
        value = units.parse(given, "m", bare_numbers_are_si=True)
    except ValueError as fault:
        raise SceneError([Fault("arguments", name, repr(given), str(fault))]) from None
    if below(value, FINEST_ELEMENTS) or below(COARSEST_ELEMENTS, value):
        between = f"{FINEST_ELEMENTS:g} to {COARSEST_ELEMENTS:g} m"
        raise SceneError([Fault("arguments", name, repr(given), between)])
    return value


def rows(given: Any) -> list[Mapping[str, Any]]:
    """Cases as a list of overrides: a list of mappings, a mapping of columns, a table of pandas, a
    data set of xarray, or a structured array of numpy. Raises SceneError."""
    if hasattr(given, "data_vars"):  # xarray
        given = {str(name): given[name].values for name in given.data_vars}
    elif hasattr(given, "columns") and hasattr(given, "iloc"):  # pandas, which is not imported
        given = {str(name): given[name].tolist() for name in given.columns}
    elif names := getattr(getattr(given, "dtype", None), "names", None):
        given = {name: given[name] for name in names}
    if isinstance(given, Mapping):
        return _of_columns(given)
    expected = (
        "overrides by dotted key: a list of mappings, a mapping of columns, a table of pandas, a data "
        "set of xarray, a structured array; or distributions by name or path"
    )
    if not isinstance(given, Sequence) or isinstance(given, (str, bytes)):
        raise SceneError([Fault("arguments", "cases", kind_of(given), expected)])
    wrong = [place for place, row in enumerate(given) if not isinstance(row, Mapping)]
    if wrong:
        found = f"{kind_of(given[wrong[0]])} as case {wrong[0]}"
        raise SceneError([Fault("arguments", "cases", found, expected)])
    if not given:
        raise SceneError([Fault("arguments", "cases", "no case", "at least one")])
    _require_keys(key for row in given for key in row)
    return list(given)


def _require_keys(given: Iterable[Any]) -> None:
    """Raise SceneError for keys that no scene has; otherwise every case would be refused."""
    unknown = {
        key: None
        for key in dict.fromkeys(given)
        if not isinstance(key, str) or not overrides.is_key(Scene, key)
    }
    if unknown:
        raise SceneError(
            [
                Fault(
                    "arguments",
                    f"cases.{key}" if isinstance(key, str) else "cases",
                    repr(key),
                    suggestions.expected(Scene, key, overrides.NO_SUCH_KEY)
                    if isinstance(key, str)
                    else "a dotted key as text",
                )
                for key in unknown
            ]
        )


def _of_columns(columns: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    lengths: dict[str, int] = {}
    faults = []
    for name, column in columns.items():
        if isinstance(column, (str, bytes, Mapping)) or getattr(column, "shape", (0,)) == ():
            faults.append(Fault("arguments", f"cases.{name}", repr(column), "a list of values"))
            continue
        try:
            lengths[name] = len(column)
        except TypeError:
            faults.append(Fault("arguments", f"cases.{name}", repr(column), "a list of values"))
    if len(set(lengths.values())) > 1:
        found = ", ".join(f"{count} of {name}" for name, count in lengths.items())
        faults.append(Fault("arguments", "cases", found, "columns of one length"))
    if not faults and not any(lengths.values()):
        faults.append(Fault("arguments", "cases", "no case", "at least one"))
    if faults:
        raise SceneError(faults)
    _require_keys(columns)
    items = [[plain(value) for value in column] for column in columns.values()]
    return [dict(zip(columns, values)) for values in zip(*items)]


def plain(value: Any) -> Any:
    """A scalar of numpy as a Python value."""
    return (
        value.item() if getattr(value, "shape", None) == () and hasattr(value, "dtype") else value
    )


def _number(name: str, value: Any) -> Any:
    if name in _LENGTHS and value is not None:
        return units.parse(value, _LENGTHS[name], bare_numbers_are_si=True)
    value = plain(value)
    if name in ("relative_tolerance", "safety"):
        return units.parse(value, "dimensionless", bare_numbers_are_si=True)
    whole = name in ("cells", "degree", "maximum_steps") and value != "auto"
    if whole and value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise ValueError("a whole number")
    return value
