"""The formats of files that are read, from the declarations of their readers.

python -m docs.pages.format_tables        writes them into docs/reference/file_formats.md
"""

from pathlib import Path

from docs.pages.markdown import table
from tipoff.formats.declared import declared

PAGE = Path(__file__).resolve().parents[1] / "reference" / "file_formats.md"
_HEADS = {
    "meshes": ("file", "read", "groups that can be walls and mounts"),
    "sections": ("file", "read"),
    "thrusts": ("format", "what is read", "units", "how columns and motors are named"),
    "logs": ("format", "`[columns]` of the sheet", "units"),
    "curves": ("format", "what is read", "`--body`", "units", "axes of the rates"),
}


def written() -> str:
    """The text of the page, with the formats of each room between its comments."""
    page = PAGE.read_text(encoding="utf-8")
    for room, heads in _HEADS.items():
        rows = [row for each in declared(f"tipoff.formats.{room}") for row in each.rows]
        before, rest = page.split(f"<!-- formats of {room} -->\n")
        end = f"<!-- end of {room} -->\n"
        after = rest.split(end)[1]
        page = f"{before}<!-- formats of {room} -->\n\n{table(heads, rows)}\n\n{end}{after}"
    return page


if __name__ == "__main__":
    PAGE.write_text(written(), encoding="utf-8")
