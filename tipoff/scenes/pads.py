"""Pads by pattern: a ``[pads]`` table instead of one ``[[pads]]`` each.

    [pads]
    stations = ["-80 mm", "80 mm"]   # X of the pads
    corner = ["100 mm", "100 mm"]    # distance of the corners from the axis along Y and Z
    inset = "9 mm"                   # and every other key of a pad

has a pad at each of the four corners of each station, with the two outward normals. The list of
pads replaces it when a scene is read, so overrides, hashes and results only know lists.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from tipoff.scenes.table import MOST

_SIGNS = (-1, 1)
_PLACES = {"stations": "position", "corner": "position"}
_Faults = list[tuple[str, str, str]]


def expand(raw: dict) -> _Faults:
    """Replace a pattern in ``raw`` by its pads in place, also in ``[provenance]`` with dotted or
    nested keys; returns the faults (key, given, expected) of the pattern."""
    pattern = raw.get("pads")
    if not isinstance(pattern, dict):
        return []
    if faults := list(_faults(pattern)):
        return faults
    common = {key: value for key, value in pattern.items() if key not in _PLACES}
    y, z = pattern["corner"]
    raw["pads"] = [
        {
            "position": [station, _signed(y, side), _signed(z, height)],
            "normals": [f"{_sign(side)}y", f"{_sign(height)}z"],
            **common,
        }
        for station in pattern["stations"]
        for side in _SIGNS
        for height in _SIGNS
    ]
    if isinstance(stated := raw.get("provenance"), Mapping):
        raw["provenance"] = _of_each(stated, len(raw["pads"]))
    return []


def _faults(pattern: dict) -> Iterator[tuple[str, str, str]]:
    stations, corner = pattern.get("stations"), pattern.get("corner")
    if not isinstance(stations, list) or not 0 < len(stations) <= MOST // 4:
        yield "pads.stations", repr(stations), 'a list of places, for example ["-80 mm", "80 mm"]'
    if not isinstance(corner, list) or len(corner) != 2:
        yield "pads.corner", repr(corner), 'distances along Y and Z, such as ["100 mm", "100 mm"]'
    for key in ("position", "normals", "foot"):
        if key in pattern:
            yield f"pads.{key}", repr(pattern[key]), "no such key with stations and corner"


def _sign(sign: int) -> str:
    return "+" if sign > 0 else "-"


def _signed(value: Any, sign: int) -> Any:
    """A text with its unit, or a number, times ``sign``; anything else unchanged, for the scene to
    refuse."""
    if sign > 0 or isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        return -value
    if not isinstance(value, str):
        return value
    text = value.strip()
    return text[1:] if text.startswith("-") else f"-{text.removeprefix('+')}"


def _of_each(stated: Mapping[str, Any], pads: int) -> dict[str, Any]:
    """The provenance ``stated``, with the text of a key of the pattern under the same key of each
    pad."""
    found: dict[str, Any] = {}
    for key, text in stated.items():
        table, _, name = key.partition(".")
        if table != "pads" or not name or name.partition(".")[0].isdigit():
            found[key] = text
            continue
        part = _PLACES.get(name.partition(".")[0], name)
        found |= {f"pads.{place}.{part}": text for place in range(pads)}
    return found
