"""Where the quantities of a curve are in a file: columns, units, body and axes, from the options of
a command.

    --columns "time=Time, rate_x=WX, rate_y=-WZ"     by header or number, with a sign
    --units "adams: time=ms, rate=deg/s"             for the file with the name adams only
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from tipoff.faults import Fault, SceneError, close
from tipoff.formats.curves.record import BODY, SCENE
from tipoff.units import duration, to_si

QUANTITIES = {
    "time": "s",
    "velocity_x": "m/s",
    "rate_x": "rad/s",
    "rate_y": "rad/s",
    "rate_z": "rad/s",
}
RATES = ("rate_x", "rate_y", "rate_z")
LENGTH, RATE = "length", "rate"  # units of a consistent system, and of all rates


class Layout(NamedTuple):
    """Layout of one file; the defaults are those of its format."""

    columns: tuple[tuple[str, str], ...] = ()  # quantity and column
    units: tuple[tuple[str, str], ...] = ()  # quantity, "rate" or "length", and unit
    body: str | None = None  # number of a body or node, name of a part
    axes: str | None = None  # of the rates: "body" or "scene"
    ignition: float = 0.0  # s, of the file

    @property
    def words(self) -> str:
        """What it states as text; empty for the defaults."""
        pairs = {"columns": self.columns, "units": self.units}
        said = [
            f"{name} {', '.join(f'{key}={value}' for key, value in own)}"
            for name, own in pairs.items()
            if own
        ]
        said += [f"body {self.body}"] if self.body is not None else []
        said += [f"rates in {self.axes} axes"] if self.axes is not None else []
        said += [f"ignition at {duration(self.ignition)}"] if self.ignition else []
        return "; ".join(said)

    def unit(self, name: str) -> str | None:
        """The stated unit of a quantity."""
        units = dict(self.units)
        return units.get(name) or (units.get(RATE) if name in RATES else None)

    def filled(self, pattern: str) -> str | None:
        """A unit from the stated ones of time and length; None without them."""
        try:
            return pattern.format_map(dict(self.units))
        except KeyError:
            return None


OF_THE_FORMAT = Layout()


def of_options(
    names: Sequence[str],
    columns: Iterable[str] = (),
    units: Iterable[str] = (),
    body: Iterable[str] = (),
    axes: Iterable[str] = (),
    ignition: Iterable[str] = (),
) -> dict[str, Layout]:
    """The layout of each file by name. Each text of an option is for all files, or for one, "NAME:
    ...", whose values replace those for all. Raises SceneError listing every fault."""
    found: dict[str, dict[str, Any]] = {name: {} for name in names}
    faults: list[Fault] = []

    def take(option: str, texts: Iterable[str], read: Callable[[str], Any]) -> None:
        key = option.removeprefix("--")
        split = [_of_one(text, names) for text in texts]
        for owner, rest in sorted(split, key=lambda item: item[0] is not None):
            try:
                value = read(rest)
            except SceneError as error:
                faults.extend(error.faults)
                continue
            for name in names if owner is None else (owner,):
                old = found[name].get(key)
                found[name][key] = {**old, **value} if isinstance(old, dict) else value

    take("--columns", columns, lambda text: _pairs("--columns", text, QUANTITIES))
    take("--units", units, lambda text: _pairs("--units", text, (*QUANTITIES, RATE, LENGTH)))
    take("--body", body, str)
    take("--axes", axes, _axes)
    take("--ignition", ignition, _time)
    if faults:
        raise SceneError(faults)
    return {name: _layout(given) for name, given in found.items()}


def _layout(given: dict[str, Any]) -> Layout:
    """The layout of one file; dictionaries become tuples, which cannot change."""
    fixed: dict[str, Any] = {
        key: tuple(value.items()) if isinstance(value, dict) else value
        for key, value in given.items()
    }
    return Layout(**fixed)


def _of_one(text: str, names: Sequence[str]) -> tuple[str | None, str]:
    """The name of a file in front of a colon, None without one, and the rest."""
    name, colon, rest = text.partition(":")
    if colon and name.strip() in names:
        return name.strip(), rest.strip()
    return None, text.strip()


def _pairs(option: str, text: str, known: Iterable[str]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    faults = []
    for item in filter(None, map(str.strip, text.split(","))):
        name, equals, value = (part.strip() for part in item.partition("="))
        if not equals or not value:
            faults.append(Fault(option, name or "value", f"{item!r}", "QUANTITY=TEXT"))
        elif name not in known:
            words = f"one of {', '.join(known)}{close(name, known)}"
            faults.append(Fault(option, "quantity", f"{name!r}", words))
        elif name in pairs:
            faults.append(Fault(option, name, "twice", "once"))
        pairs[name] = value
    if faults:
        raise SceneError(faults)
    return pairs


def _time(text: str) -> float:
    try:
        return to_si(text, "s")
    except ValueError as error:
        raise SceneError([Fault("--ignition", "value", f"{text!r}", str(error))]) from None


def _axes(text: str) -> str:
    if text not in (BODY, SCENE):
        raise SceneError([Fault("--axes", "value", f"{text!r}", f"{BODY} or {SCENE}")])
    return text
