"""One table or document, rendered as HTML, as Markdown and for the terminal."""

import pytest

from tipoff.studies.populations.spread import Quantile
from tipoff.studies.render import document
from tipoff.studies.render.chart import Chart
from tipoff.studies.render.document import Bullets, Caption, Figure, Fold, Heading, Notice
from tipoff.studies.render.table import (
    Column,
    Noted,
    Table,
    estimate,
    html,
    markdown,
    number,
    percent,
    span,
    terminal,
)
from tipoff.uncertain import Measured

TABLE = Table(
    ["condition", Column("rate", "deg/s", "+.2f"), Column("drift", "J", scale=100.0), "steps"],
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


@pytest.mark.parametrize(
    "value, form, shown",
    [
        (0.00832, ".3g", "0.008"),
        (1.64, ".3g", "1.64"),
        (0.0821, ".2g", "0.082"),
        (7.64e-11, ".2g", "<0.001"),
        (0.0, ".2g", "0"),
        (-5.2e-11, "+.2g", "0.000"),
        (5.2e-11, "+.2g", "0.000"),
        (0.014, "+.3g", "+0.014"),
        (float("nan"), ".3g", "nan"),
    ],
)
def test_no_digit_stands_below_the_least_step(value, form, shown):
    assert number(value, form, 1e-3) == shown


def test_the_unit_of_a_column_sets_the_least_step():
    """Control: without a unit every digit stands."""
    columns = [Column("rate", "deg/s"), Column("share", "%", scale=100.0), Column("ratio")]
    assert ">&lt;0.001<" in html(Table(columns, [[7.64e-11, 0.5, 1.0]]))
    assert "| 0.013 | 50 | 7.64e-11 |" in markdown(Table(columns, [[0.01278, 0.5, 7.64e-11]]))


def test_a_unit_in_brackets_counts_in_heads_and_rows():
    rows = [["rate about x (deg/s)", 7.64e-11, 0.5], ["drift", 7.64e-11, 0.5]]
    lines = markdown(Table(["quantity", "change", "share (%)"], rows)).splitlines()
    assert lines[2:] == [
        "| rate about x (deg/s) | <0.001 | 0.5 |",
        "| drift | 7.64e-11 | 0.5 |",
    ]
    assert "| <0.001 |" in markdown(Table(["rate (deg/s)"], [[7.64e-11]]))


def test_a_value_carries_its_uncertainty():
    columns = [Column("rate", "deg/s"), Column("force", "kN", "+.3g", 1e-3), Column("x, y", "mm")]
    both = [Measured(0.01234, 0.002), Measured(5071.2, 12.0), Measured((1.26, -3e-9), 0.3)]
    assert "| 0.012 ± 0.002 | 5.071 ± 0.012 | 1.3 ± 0.3, 0.0 ± 0.3 |" in markdown(
        Table(columns, [both])
    )
    alone = [Measured(cell.value, cell.uncertainty, apart=True) for cell in both]
    assert "| 0.012 | +5.071 | 1.3, 0.0 |" in markdown(Table(columns, [alone]))
    unknown = [Measured(None, 1.0), Measured(5071.2, None), Measured(1.26, 0.0)]
    assert "| – | +5.07 | 1.26 |" in markdown(Table(columns, [unknown]))


def test_estimates_are_rounded_to_their_interval():
    shown = markdown(Table(["rate"], [[estimate(Quantile(0.5, 5.0712, 4.961, 5.311))], [None]]))
    assert "| 5.07 (4.96 to 5.31) |" in shown
    assert estimate(Quantile(0.5, 2.0, None, None)) == 2.0


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
    assert lines[2] == "| condition | rate (deg/s) | drift (J) | steps |"
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
    """The terminal and Markdown make no chart. Control: the page makes it."""
    made = []

    def curve():
        made.append(Chart("curve"))
        return made[0]

    parts = [
        "a & b",
        "",
        Heading("More"),
        Caption("small"),
        Notice("careful"),
        Bullets(["first", "second."]),
        Figure(curve, "the curve"),
        Fold("detail", [TABLE]),
    ]
    assert document.terminal(parts) and document.markdown(parts) and not made
    shown = document.html(parts, lambda chart, words: f"<b>{chart.name} {words}</b>")
    assert len(made) == 1
    assert "<p>a &amp; b</p>" in shown and "<h3>More</h3>" in shown
    assert "<li>First.</li><li>Second.</li>" in shown and "<b>curve the curve</b>" in shown
    assert shown.count("<details>") == 1 and "+1.23" in shown and "<p></p>" not in shown
    text = document.terminal(parts)
    assert "careful" in text and "second." in text and "1.23" not in text
    assert "- First." in document.markdown(parts) and "+1.23" in document.markdown(parts)
