"""One table or document, rendered as HTML, as Markdown and for the terminal."""

import pytest

from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart
from tipoff.studies.render.document import Bullets, Caption, Figure, Fold, Heading, Notice
from tipoff.studies.render.table import (
    Column,
    Noted,
    Table,
    html,
    markdown,
    number,
    percent,
    span,
    terminal,
)

TABLE = Table(
    ["condition", Column("rate", "deg/s", "+.2f"), Column("L2", "%", scale=100.0), "steps"],
    [["<phi0>", 1.234, 1e-9, 12345], ["a|b", None, Noted(0.5, "0.4 to 0.6"), True]],
    notes=("Run `make cost`.",),
    title="Agreement",
    name="agreement",
    kinds=["best", "bad"],
    dense=True,
)


@pytest.mark.parametrize(
    "value, form, shown",
    [
        (0.01234, ".3g", "0.0123"),
        (1.234e-9, ".3g", "1.23e-09"),
        (None, ".3g", "–"),
        (113.4, ".2g", "113"),
        (-12345.6, "+.3g", "-12346"),
        (2.2e9, ".2g", "2.2e+09"),
        (12.0, ".1e", "1.2e+01"),
    ],
)
def test_number(value, form, shown):
    assert number(value, form) == shown


def test_percent_and_span():
    assert percent(0.0125) == "1.25" and percent(None) == "–"
    assert span(1.0, 2.5) == "1 to 2.5" and span(None, None) == "–"


def test_html_escapes_and_aligns():
    shown = html(TABLE)
    assert "<td>&lt;phi0&gt;</td>" in shown and '<td class="number">+1.23</td>' in shown
    assert "1·10<sup>-7</sup>" in shown and "<th>rate (deg/s)</th>" in shown
    assert '50 <span class="small">0.4 to 0.6</span>' in shown
    assert '<td class="number">12,345</td>' in shown and "<td>yes</td>" in shown
    assert 'id="agreement"' in shown and '<tr class="best">' in shown
    assert "<code>make cost</code>" in shown


def test_markdown():
    lines = markdown(TABLE).splitlines()
    assert lines[0] == "Agreement" and lines[-1] == "Run `make cost`."
    assert lines[2] == "| condition | rate (deg/s) | L2 (%) | steps |"
    assert lines[4] == "| **<phi0>** | +1.23 | 1e-07 | 12,345 |"
    assert lines[5] == "| a\\|b | – | 50 (0.4 to 0.6) | yes |"


def test_terminal():
    lines = terminal(TABLE).splitlines()
    assert lines[0] == "Agreement" and lines[-1] == "Run `make cost`."
    assert any(line.split() == ["<phi0>", "+1.23", "1e-07", "12,345"] for line in lines)


def test_terminal_breaks_lines_between_words():
    """Columns are narrowed to their longest word; a table of long words is wider than the limit."""
    rows = [["conditions of the reference " * 3, "12.5 (10 to 20)"] + ["longest_word_of_all"] * 4]
    lines = terminal(Table(list("abcdef"), rows)).splitlines()
    text = " ".join(lines)
    assert "…" not in text and text.count("longest_word_of_all") == 4
    assert all(len(line) <= 160 for line in lines) and len(lines) > 4


def test_a_table_without_rows_has_heads():
    empty = Table(["a", "b"], [])
    assert "<th>b</th>" in html(empty) and "| a | b |" in markdown(empty) and "b" in terminal(empty)


def test_document():
    parts = [
        "a & b",
        "",
        Heading("More"),
        Caption("small"),
        Notice("careful"),
        Bullets(["first", "second."]),
        Figure(Chart("curve"), "the curve"),
        Fold("detail", [TABLE]),
    ]
    shown = document.html(parts, lambda chart, words: f"<b>{chart.name} {words}</b>")
    assert "<p>a &amp; b</p>" in shown and "<h3>More</h3>" in shown
    assert "<li>First.</li><li>Second.</li>" in shown and "<b>curve the curve</b>" in shown
    assert shown.count("<details>") == 1 and "+1.23" in shown and "<p></p>" not in shown
    text = document.terminal(parts)
    assert "careful" in text and "second." in text and "1.23" not in text
    assert "- First." in document.markdown(parts) and "+1.23" in document.markdown(parts)
