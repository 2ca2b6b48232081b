"""Mutants by their seed: of text, of the values of a scene, and of the numbers and bytes of other
files."""

import random
import re
from typing import Any

import meshio
import numpy as np

from tipoff import toml

Random = random.Random
NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
EDITS = (1, 1, 1, 2, 4)  # so that many mutants pass the first check
NUMBERS = (
    *(
        "0",
        "-1",
        "1",
        "1e-320",
        "1e-200",
        "1e-30",
        "1e-9",
        "1e9",
        "1e30",
        "1e200",
        "1e308",
        "1e400",
    ),
    *(
        "nan",
        "inf",
        "-inf",
        "9" * 400,
        "9" * 5000,
        "2147483647",
        "2147483648",
        "18446744073709551616",
    ),
)
UNITS = (
    *(
        "m",
        "mm",
        "nm",
        "km",
        "kg",
        "s",
        "ms",
        "deg",
        "rad",
        "N",
        "kN",
        "Pa",
        "GPa",
        "K",
        "degC",
        "1/K",
    ),
    *(
        "N/mm**1.5",
        "kg*m**2",
        "N*s/m",
        "m/s**2",
        "kg*9**9**9",
        "m**9**9**9",
        "dB",
        "%",
        "°",
        "m²",
        "",
    ),
    *("(" * 300, "kg*" * 300 + "kg", "degC*m", "kg**0.5**99", "delta_degC", "N per mm", "m/0", "1"),
)
NAMES = (
    *(
        "",
        "a",
        "a" * 300,
        "\0",
        "../x",
        "/",
        "nominal",
        "²",
        "0",
        "-1",
        "9" * 20,
        "absent",
        "contact",
    ),
    *("a.b", ".", "pads.0.relief", "pads.².relief", "pads.99", "\ud7ff", "é", "\u202e", "con"),
)
PATHS = ("/dev/zero", "/dev/null", "/", "/proc/self/mem", "a" * 300, "a\0b", "", "../" * 2000 + "x")
TOKENS = (
    *(
        "[",
        "]",
        "[[",
        "]]",
        "{",
        "}",
        "=",
        '"',
        '"""',
        "'",
        ",",
        ".",
        "#",
        "\n",
        "\ufeff",
        "\0",
        "\\u0000",
    ),
    *(
        "true",
        "1979-05-27",
        "inf",
        "nan",
        '"absent"',
        "[" * 600,
        "a." * 600 + "b=1\n",
        "x = " + "9" * 400,
    ),
)


def of_text(rng: Random, text: str) -> str:
    """One to four edits of the lines and tokens of a text."""
    lines = text.split("\n")
    for _ in range(rng.choice(EDITS)):
        place = rng.randrange(len(lines))
        line = lines[place]
        cut = rng.randint(0, len(line))
        lines[place : place + 1] = rng.choice(
            (
                [],
                [line, line],
                [line[:cut]],
                [line[:cut] + rng.choice(TOKENS) + line[cut:]],
                [line[:cut] + chr(rng.randrange(1, 0xD7FF)) + line[cut + 1 :]],
                [rng.choice(lines), line],
                [_with_number(rng, line)],
                [_with_number(rng, line)],
            )
        ) or [""]
    return "\n".join(lines)


def of_scene(rng: Random, raw: dict[str, Any]) -> str:
    """TOML of a scene with one to three of its values, keys or tables changed."""
    for _ in range(rng.randint(1, 3)):
        _change(rng, raw)
    return toml.dumps(raw)


def of_plain(rng: Random, value: dict[str, Any]) -> dict[str, Any]:
    """One to three values, keys or tables of JSON changed, in place."""
    for _ in range(rng.randint(1, 3) if isinstance(value, dict) else 0):
        _change(rng, value)
    return value


def of_bytes(rng: Random, content: bytes) -> bytes:
    """One to six edits of the bytes and numbers of a file."""
    for _ in range(rng.choice(EDITS)):
        if not content:
            break
        place, how = rng.randrange(len(content)), rng.randrange(6)
        end = min(len(content), place + rng.choice((1, 4, 8, 64, 4096)))
        if how == 0:
            content = content[:place] + rng.randbytes(end - place) + content[end:]
        elif how == 1:
            content = content[:place] + content[end:]
        elif how == 2:
            content = content[:place] + content[place:end] * 2 + content[end:]
        elif how == 3:
            content = content[:place]
        elif found := NUMBER.search(content, place):
            number = rng.choice(NUMBERS[:-6]).encode()
            content = content[: found.start()] + number + content[found.end() :]
    return content


def of_mesh(rng: Random, mesh: meshio.Mesh) -> meshio.Mesh:
    """A mesh with some of its places, nodes of elements or groups changed."""
    points, cells = mesh.points.copy(), [block.data.copy() for block in mesh.cells]
    tags = [tag.copy() for tag in mesh.cell_data["gmsh:physical"]]
    names = dict(mesh.field_data)
    for _ in range(rng.choice(EDITS)):
        how, block = rng.randrange(7), rng.randrange(len(cells))
        row = rng.randrange(len(cells[block]))
        if how == 0:
            points *= rng.choice((1e3, 1e-3, 1e-9, 25.4, -1.0, 0.0, 1e200))
        elif how == 1:
            points[rng.randrange(len(points))] = float(rng.choice(NUMBERS[:15]))
        elif how == 2:
            points[rng.randrange(len(points))] += rng.uniform(-0.01, 0.01)
        elif how == 3:
            cells[block][row] = np.roll(cells[block][row], rng.randrange(1, 4))
        elif how == 4:
            cells[block][row, 0] = rng.randrange(len(points))
        elif how == 5:
            cells[block] = np.concatenate([cells[block], cells[block][row : row + 1]])
            tags[block] = np.concatenate([tags[block], tags[block][row : row + 1]])
        else:
            name = rng.choice(list(names))
            names[rng.choice(("mount", "contact", "other"))] = names.pop(name)
    blocks = [(old.type, new) for old, new in zip(mesh.cells, cells)]
    data = {"gmsh:physical": tags, "gmsh:geometrical": [tag.copy() for tag in tags]}
    return meshio.Mesh(points, blocks, cell_data=data, field_data=names)


def _with_number(rng: Random, line: str) -> str:
    found = list(re.finditer(r"\d+\.?\d*", line))
    if not found:
        return line
    one = rng.choice(found)
    return line[: one.start()] + rng.choice(NUMBERS) + line[one.end() :]


def _change(rng: Random, raw: dict[str, Any]) -> None:
    table: Any = raw
    while True:  # walk down to some depth
        keys = list(table) if isinstance(table, dict) else list(range(len(table)))
        if not keys:
            return
        key = rng.choice(keys)
        if isinstance(table[key], (dict, list)) and table[key] and rng.random() < 0.75:
            table = table[key]
            continue
        break
    if rng.random() < 0.15:
        table.pop(key)
    elif rng.random() < 0.1 and isinstance(table, dict):
        table[rng.choice(NAMES)] = table.pop(key)
    else:
        table[key] = _value(rng, table[key])


def _value(rng: Random, old: Any) -> Any:
    kind = rng.randrange(9)
    if kind <= 2 and isinstance(old, str):  # another number in the same unit
        return re.sub(r"^[-+\d.eE]+", lambda _: rng.choice(NUMBERS), old)
    if kind == 3:
        return f"{rng.choice(NUMBERS)} {rng.choice(UNITS)}"
    if kind == 4 and isinstance(old, str):
        return f"{old.split(' ')[0]} {rng.choice(UNITS)}"
    return rng.choice(
        (
            *(
                rng.choice(PATHS),
                rng.choice(NAMES),
                rng.choice((0, -1, 10**400, True, 1e308, 1e-320)),
                [],
                {},
            ),
            *(
                [old],
                [[old]],
                {"x": old},
                "absent",
                {rng.choice(NAMES): old},
                [old] * rng.choice((2, 2000)),
            ),
        )
    )
