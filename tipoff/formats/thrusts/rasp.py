"""RASP motor files, ``.eng`` (thrustcurve.org, "RASP File Format"). Times are in s, forces in N.

A motor has a header of seven words, ``name diameter length delays propellant_mass total_mass
maker``, and points of two numbers. A blank inside of a word, as between two delays, would move
the masses: such a header is refused. Text after a semicolon is a comment. The first point (0, 0) is
not written; the last one has no thrust. Several motors may follow each other.
"""

from typing import NamedTuple

import numpy as np

from tipoff.formats.declared import Format
from tipoff.formats.thrusts.record import SECTION, Choice, Record, chosen

_WORDS = 7  # of a header; a maker may have several words
_SHOWN = 5  # wrong lines in a message
_LAYOUT = "'name diameter length delays propellant_mass total_mass maker'"


class _Motor(NamedTuple):
    header: list[str]
    time: list[float]
    force: list[float]
    lines: list[int]


def read_rasp(path: str, data: bytes, choice: Choice) -> Record:
    """The chosen motor. Raises ValueError."""
    choice.require_only(("motor",), "a RASP file")
    motors = _motors(data)
    motor = motors[chosen([(m.header[0], m.header[6]) for m in motors], choice.motor)]
    name, maker, propellant = motor.header[0], " ".join(motor.header[6:]), motor.header[4]
    time, force, lines = np.array(motor.time), np.array(motor.force), motor.lines
    if time.size and time[0] > 0.0:
        time, force, lines = np.insert(time, 0, 0.0), np.insert(force, 0, 0.0), [lines[0], *lines]
    words = f"RASP, motor {name} of {maker}, propellant {propellant} kg"
    return Record(time, force, words, tuple(lines), is_motor=True)


def _motors(data: bytes) -> list[_Motor]:
    found: list[_Motor] = []
    wrong: list[str] = []
    for number, line in enumerate(_text(data).splitlines(), start=1):
        words = line.partition(";")[0].split()
        if not words:
            continue
        point = _numbers(words)
        if len(words) >= _WORDS and (len(words) > len(point) or not found):
            if fault := _of_header(words):
                raise ValueError(
                    f"a RASP file with headers {_LAYOUT}, {fault} (line {number}: {line[:80]!r}); "
                    f"{SECTION}"
                )
            found.append(_Motor(words, [], [], []))
        elif len(words) == len(point) == 2 and found:
            found[-1].time.append(point[0])
            found[-1].force.append(point[1])
            found[-1].lines.append(number)
        elif not found and len(words) == len(point) == 2:
            raise ValueError(
                f"a RASP file with {_LAYOUT} first, and not only points (line {number}: {line[:80]!r}); "
                f"add that line, or give the points as a table in a file .csv; {SECTION}"
            )
        elif not found:
            raise ValueError(
                f"a RASP file with {_LAYOUT} first (line {number}: {line[:80]!r}); {SECTION}"
            )
        else:
            wrong.append(f"line {number}: {line[:80]!r}")
    if found and found[-1].force and found[-1].force[-1] != 0.0 and data[-1:] not in b"\r\n":
        raise ValueError(
            f"a whole RASP file (line {found[-1].lines[-1]}: the last one has a thrust and no end, so it may "
            f"be cut); {SECTION}"
        )
    if wrong:
        more = f" and {len(wrong) - _SHOWN} more lines" if len(wrong) > _SHOWN else ""
        raise ValueError(
            f"a RASP file with a point 'time thrust' or a header {_LAYOUT} in each line "
            f"({', '.join(wrong[:_SHOWN])}{more}); {SECTION}"
        )
    return found


def _of_header(words: list[str]) -> str:
    """What the words of a header lack; empty for a header that can be."""
    sizes = [_numbers([words[place]]) for place in (1, 2, 4, 5)]
    if not all(sizes):
        return "each a word without a blank, with numbers for sizes and masses"
    (propellant,), (total,) = sizes[2:]
    if _numbers(words[6:7]):
        return f"each a word without a blank, and not {words[6]!r} as the maker"
    if propellant > total > 0.0:
        return f"and not a propellant of {propellant:g} kg in a motor of {total:g} kg"
    return ""


def _numbers(words: list[str]) -> list[float]:
    """The words as numbers, up to the first that is none."""
    found: list[float] = []
    for word in words:
        try:
            found.append(float(word))
        except ValueError:
            break
    return found


def _text(data: bytes) -> str:
    """Old files have comments in the code page of their maker."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


FORMATS = (
    Format(
        "RASP motor (.eng)",
        read_rasp,
        [
            (
                "RASP, `.eng`",
                "points of a motor; (0, 0) is added in front of a first point after 0 s",
                "s, N",
                "`motor`: first word of the header line, or maker and name",
            )
        ],
        suffixes=(".eng",),
    ),
)
