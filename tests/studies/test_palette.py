"""Charts follow the colour scheme of the reader."""

import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from PIL import Image

import tipoff.studies
from tipoff.studies.render import document
from tipoff.studies.render.chart import Picture, to_files
from tipoff.studies.render.palette import DARK, NAVY, VERMILION, css, themed


def luminance(colour: str) -> float:
    """Relative luminance of WCAG 2."""
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    linear = [
        part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Contrast ratio of WCAG 2."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colour", [NAVY, VERMILION, "#e8a33d", "#2e8b7a", "#7a7f87", "#000000"])
def test_lines_are_seen_on_a_dark_page(colour):
    """3 is the ratio that WCAG asks of graphics. Control: navy as it is on paper has less."""
    assert contrast(DARK[colour], DARK["#ffffff"]) > 3.0
    assert contrast(NAVY, DARK["#ffffff"]) < 3.0


def test_every_colour_of_the_studies_has_a_dark_one():
    folder = Path(tipoff.studies.__file__).parent
    used = {
        colour: path.name
        for path in folder.rglob("*.py")
        if path.parent.name not in ("render", "report", "view")
        for colour in re.findall(r'"(#[0-9a-f]{6})"', path.read_text())
    }
    assert used and not {colour: name for colour, name in used.items() if colour not in DARK}


def test_an_svg_has_properties_for_colours_and_its_own_ids(tmp_path):
    figure = Figure()
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], color=NAVY)
    axes.plot([0.0, 1.0], [1.0, 0.0], color="#123456")
    _, svg = to_files(Picture("lines", figure), tmp_path)
    drawn = themed(svg.read_text(), "chart-lines", "two lines")
    assert drawn.startswith('<svg class="picture"') and "<metadata>" not in drawn
    assert "var(--c1d3461)" in drawn and NAVY not in drawn
    assert "#123456" in drawn  # control: a colour without a dark one stays
    ids = set(re.findall(r' id="([^"]+)"', drawn))
    assert ids and all(name.startswith("chart-lines") for name in ids)
    assert set(re.findall(r"url\(#([^)]+)\)", drawn)) <= ids
    assert (
        themed(f'<?xml?><svg><path style="fill: {VERMILION}"/></svg>', "x", "y").count("var(") == 1
    )


def test_the_style_has_both_values_of_each_colour():
    rules = css()
    assert "@media screen and (prefers-color-scheme: dark)" in rules  # not on paper
    for colour in DARK:
        assert rules.count(f"--c{colour[1:]}: ") == 2


def test_a_page_has_the_dark_picture_for_dark_screens_alone(tmp_path):
    for name in ("one", "other"):
        Image.new("RGB", (1, 1), "white" if name == "one" else "black").save(
            tmp_path / f"{name}.png"
        )
    drawn = document.html(
        [document.Image(tmp_path / "one.png", "a mesh", tmp_path / "other.png")], str
    )
    source = (
        '<picture><source media="screen and (prefers-color-scheme: dark)" srcset="data:image/png'
    )
    assert source in drawn and drawn.count("data:image/") == 2 and 'alt="a mesh"' in drawn
    alone = document.html([document.Image(tmp_path / "one.png", "a mesh")], str)
    assert "<picture>" not in alone and alone.count("data:image/") == 1
