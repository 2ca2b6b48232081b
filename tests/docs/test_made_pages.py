"""Pages that are made from the code: keys of a scene, and commands."""

import re
import tomllib
from collections.abc import Iterator

import pint
import pytest
from typer.testing import CliRunner

from docs.pages import command_line, format_tables, meanings, scene_keys
from tipoff.scenes.scene import CATALOG
from tipoff.scenes.table import Table
from tipoff.studies.cli import app


class Unexplained(Table):
    """Stands in for a table whose author forgot a key."""

    #: What it weighs.
    mass: float = 1.0
    length: float = 1.0


def test_a_key_without_a_meaning_is_named():
    with pytest.raises(LookupError, match="Unexplained: no comment '#: ...' above length$"):
        meanings.meanings(Unexplained)


def test_the_page_of_formats_has_every_declaration():
    """Its file is as `python -m docs.pages.format_tables` writes it."""
    page = format_tables.PAGE.read_text(encoding="utf-8")
    assert page == format_tables.written()
    assert "RockSim, `.rse`" in page and "Adams results `.res`" in page


def test_the_page_of_the_keys_is_whole_without_a_site():
    """Its file is as `python -m docs.pages.scene_keys` writes it. Control: the site has drawings too."""
    page = scene_keys.PAGE.read_text(encoding="utf-8")
    assert page == scene_keys.written()
    assert (
        "| `payload` | table | required |" in page and "## `[thrust_offset.misalignment]`" in page
    )
    assert "<svg" not in page and "<svg" in scene_keys.placed(page, scene_keys.markdown())
    assert scene_keys.placed("another page", "keys") == "another page"


def _units() -> dict[str, str]:
    """Unit by dotted key, as the page has them."""
    found = {}
    for section in scene_keys.markdown().split("## ")[1:]:
        path = re.match(r"`\[+([\w.]+)\]+`", section)
        for key, value in re.findall(r"^\| `(\w+)` \| (.*?) \|", section, re.MULTILINE):
            unit = re.search(r"`([^`\"]+)`", value)
            found[f"{path[1]}.{key}" if path else key] = unit[1] if unit else value
    return found


def _quantities(table: dict, path: str = "") -> Iterator[tuple[str, str]]:
    for key, value in table.items():
        below = f"{path}{key}"
        if isinstance(value, dict):
            yield from _quantities(value, f"{below}.")
            continue
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, dict):
                yield from _quantities(item, f"{below}.")
            else:
                yield below, item


@pytest.mark.parametrize("scene", ["reference", "tiny", "channel", "sensitive"])
def test_every_quantity_of_the_catalogue_has_the_unit_on_the_page(scene):
    """pint knows the dimension of what a scene states. Control: the unit of another key."""
    units, registry = _units(), pint.UnitRegistry()
    raw = tomllib.loads((CATALOG / f"{scene}.toml").read_text(encoding="utf-8"))
    apart = ("format", "conditions", "provenance", "agreement", "extends")
    stated = {key: item for key, item in raw.items() if key not in apart}
    checked = 0
    for key, item in _quantities(stated):
        assert key in units
        if isinstance(item, str) and re.match(r"-?[\d.]", item) and key != "contact.stiffness":
            assert registry.Quantity(item).is_compatible_with(units[key]), key
            assert not registry.Quantity(item).is_compatible_with("K")
            checked += 1
    assert checked >= 1


def test_every_option_of_a_command_is_on_the_page():
    parts = command_line.markdown().split("## ")[1:]
    sections = {part.split("\n", 1)[0].removeprefix("tipoff "): part for part in parts}
    assert set(sections) == set(command_line.commands())
    for name in ("run", "ensemble", "limits"):
        said = CliRunner(env={"COLUMNS": "200"}).invoke(app, [name, "--help"]).output
        options = set(re.findall(r"│ (--[a-z-]+)", said)) - {"--help"}
        assert len(options) > 3 and all(f"`{option}" in sections[name] for option in options)


def test_a_table_with_geometry_has_a_drawing_that_names_its_keys():
    """Each drawing stands in a section and names two of its keys or more, or its only ones.
    Control: a section without geometry has none."""
    sections = scene_keys.markdown().split("\n## ")
    drawn = {}
    for section in sections:
        keys = set(re.findall(r"^\| `(\w+)`", section, flags=re.MULTILINE))
        labels = " ".join(re.findall(r"<text[^>]*>([^<]*)</text>", section))
        if "<svg" in section:
            words = set(re.findall(r"\w+", labels))
            drawn[section.splitlines()[0]] = keys & words
            assert section.count('role="img"') == section.count("aria-label=") and keys & words
    assert {heading.split("`")[1] for heading in drawn} == {
        *(
            "[payload]",
            "[[pads]]",
            "[rail]",
            "[contact]",
            "[platform]",
            "[mass_offset.eccentricity]",
        ),
        *(f"[thrust_offset{part}]" for part in ("", ".misalignment", ".eccentricity")),
    }
    assert drawn["`[[pads]]`"] >= {"position", "length", "width", "inset"}
    section = {"leg", "thickness", "mount_width"}
    assert drawn["`[rail]`, built-in section"] >= {"start", "end", "mounts"} | section
    assert not any("Sampling" in section and "<svg" in section for section in sections)
