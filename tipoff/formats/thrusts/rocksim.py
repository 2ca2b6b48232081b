"""RockSim motor files, ``.rse``: XML with ``<engine code mfg ...>`` and, below it, ``<eng-data t f
.../>``. Times are in s, forces in N.

The parser is expat. A file with a document type is refused, so nothing can define an entity.
"""

from typing import NamedTuple, NoReturn
from xml.parsers import expat

import numpy as np

from tipoff.formats.declared import Format
from tipoff.formats.thrusts.record import SECTION, Choice, Record, chosen


class _Engine(NamedTuple):
    attributes: dict[str, str]
    points: list[tuple[int, str, str]]  # line, time, force


def read_rocksim(path: str, data: bytes, choice: Choice) -> Record:
    """The chosen engine. Raises ValueError."""
    choice.require_only(("motor",), "a RockSim file")
    engines = _engines(data)
    names = [(e.attributes.get("code", ""), e.attributes.get("mfg", "")) for e in engines]
    place = chosen(names, choice.motor)
    (code, maker), engine = names[place], engines[place]
    points = []
    for line, *texts in engine.points:
        try:
            points.append([float(text) for text in texts])
        except ValueError:
            shown = " ".join(f"{key}={text[:40]!r}" for key, text in zip("tf", texts))
            raise ValueError(
                f"numbers t and f in each eng-data (line {line}: {shown}); {SECTION}"
            ) from None
    time, force = np.array(points).reshape(-1, 2).T
    stated = engine.attributes.get("Itot")
    impulse = f", {stated} N s by the file" if stated else ""
    lines = tuple(line for line, *_ in engine.points)
    return Record(time, force, f"RockSim, motor {code} of {maker}{impulse}", lines, is_motor=True)


def _engines(data: bytes) -> list[_Engine]:
    found: list[_Engine] = []
    is_open = False
    parser = expat.ParserCreate()

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal is_open
        if name == "engine":
            found.append(_Engine(attributes, []))
            is_open = True
        elif name == "eng-data" and is_open:
            texts = attributes.get("t", ""), attributes.get("f", "")
            found[-1].points.append((parser.CurrentLineNumber, *texts))

    def end(name: str) -> None:
        nonlocal is_open
        is_open = is_open and name != "engine"

    def refuse(*_: object) -> NoReturn:
        raise ValueError(
            f"a RockSim file without a document type (line {parser.CurrentLineNumber}); {SECTION}"
        )

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(f"a RockSim file, which is XML ({error}); {SECTION}") from error
    except LookupError as error:  # an encoding that is not known
        raise ValueError(f"a RockSim file in a known encoding ({error}); {SECTION}") from error
    return found


FORMATS = (
    Format(
        "RockSim motor (.rse)",
        read_rocksim,
        [
            (
                "RockSim, `.rse`",
                "`t` and `f` of each `eng-data` of an engine",
                "s, N",
                "`motor`: `code`, or `mfg` and `code`",
            )
        ],
        suffixes=(".rse",),
    ),
)
