"""The small rail as a keyword file of LS-DYNA, in the columns of the Keyword User's Manual, volume I:
``*NODE`` has 8, 16, 16, 16, 8, 8 columns, ``*ELEMENT`` 8 each, ``*PART`` and ``*SET`` 10 each."""

from tests.formats.meshes import seeds

STANDARD, I10, LONG, FREE = "standard", "i10", "long", "free"
HEADERS = {STANDARD: "*KEYWORD", I10: "*KEYWORD I10=Y", LONG: "*KEYWORD LONG=Y", FREE: "*KEYWORD"}


def line(form: str, widths: list[int], *values) -> str:
    """Values at the right of their columns, or with commas."""
    if form == FREE:
        return ",".join(map(str, values))
    if form == LONG:
        widths = [20] * len(widths)
    if form == I10:
        widths = [10 if width == 8 else width for width in widths]
    return "".join(f"{value!s:>{width}}" for value, width in zip(values, widths))


def text(form: str = STANDARD, surfaces: str = "segments", two_lines: bool = False) -> str:
    """The plate; its surfaces are sets of segments, of nodes, of shells, parts of shells, or sets of
    such parts."""
    points, cells, named = seeds.rail()
    lines = ["$ a rail", HEADERS[form], "*TITLE", "a rail", "*NODE", "$#   nid               x"]
    for number, place in enumerate(points, 1):
        lines.append(line(form, [8, 16, 16, 16, 8, 8], number, *(f"{x:.9g}" for x in place), 0, 0))
    lines += ["*PART", "$#  title", "the rail", line(form, [10] * 8, 7, 1, 1)]
    lines.append("*ELEMENT_SOLID")
    for number, row in enumerate(cells + 1, 1):
        if two_lines:
            lines += [line(form, [8] * 10, number, 7), line(form, [8] * 10, *row, 0, 0)]
        else:
            lines.append(line(form, [8] * 10, number, 7, *row))
    number = 0
    for owner, (name, facets) in enumerate(named.items(), 20):
        if surfaces in ("segments", "nodes"):
            kind = "SEGMENT" if surfaces == "segments" else "NODE_LIST"
            lines += [f"*SET_{kind}_TITLE", name, line(form, [10] * 8, owner, 0.0, 0.0, 0.0, 0.0)]
            rows = [[*row, 0.0, 0.0, 0.0, 0.0] for row in (facets + 1).tolist()]
            if surfaces == "nodes":
                every = sorted({node for row in rows for node in row[:4]})
                rows = [every[at : at + 8] for at in range(0, len(every), 8)]
            lines += [line(form, [10] * 8, *row) for row in rows]
            continue
        lines += [
            "*PART",
            name if surfaces == "parts" else "shells",
            line(form, [10] * 8, owner, 2, 1),
        ]
        lines.append("*ELEMENT_SHELL")
        first = number + 1
        for row in facets + 1:
            number += 1
            lines.append(line(form, [8] * 10, number, owner, *row))
        if surfaces == "shells":
            lines += ["*SET_SHELL_LIST_GENERATE_TITLE", name, line(form, [10] * 8, owner)]
            lines.append(line(form, [10] * 8, first, number))
        elif surfaces == "sets of parts":
            lines += ["*SET_PART_LIST_TITLE", name, line(form, [10] * 8, owner)]
            lines.append(line(form, [10] * 8, owner))
    return "\n".join([*lines, "*END", "what follows is not read", ""])
