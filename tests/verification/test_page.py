"""The page fits the cases, the tests, what is recorded and the measurements."""

import pytest

from tests.test_cases import ONLY_SLOW
from tests.verification import page, reading

RECORDED = page.recorded()


def test_the_page_is_up_to_date():
    """`python -m tests.verification` writes it."""
    assert page.PAGE.read_text() == page.text(), "write it again: python -m tests.verification"


def test_the_page_follows_what_is_recorded(monkeypatch):
    """Control: another value is another page."""
    name = next(name for name, entry in RECORDED.items() if entry["worst"])
    entry = RECORDED[name] | {"comparisons": RECORDED[name]["comparisons"] + 1}
    monkeypatch.setattr(page, "recorded", lambda: RECORDED | {name: entry})
    assert page.PAGE.read_text() != page.text()


def test_every_case_is_recorded_by_a_test_that_exists():
    known = {f"{test.file}::{test.name}": test for test in reading.all_tests()}
    assert set(RECORDED) <= set(known)
    assert all(entry["cases"] == list(known[name].cases) for name, entry in RECORDED.items())
    ids = {row[0] for _, rows in page.sections(page.CASES.read_text()) for row in rows}
    assert ids - {case for entry in RECORDED.values() for case in entry["cases"]} == ONLY_SLOW


def test_no_recorded_error_is_beyond_its_tolerance():
    assert max(entry["worst"]["ratio"] for entry in RECORDED.values() if entry["worst"]) <= 1.0


@pytest.mark.parametrize(
    "found, expected",
    [
        (None, ("yes or no", "–", "–")),
        (
            {"ours": 2.5e-6, "answer": 0.0, "allowed": 1e-4, "ratio": 0.025},
            ("error 2.5e-06", "≤ 1.0e-04", "0.03"),
        ),
        (
            {"ours": 1.01, "answer": 1.0, "allowed": 0.02, "ratio": 0.5},
            ("1.01", "1 ± 2.0e-02", "0.50"),
        ),
    ],
)
def test_an_error_stands_by_itself(found, expected):
    assert page.nearest(found) == expected


def test_other_codes_are_shown_where_there_is_a_table(monkeypatch, tmp_path):
    """Control: without the file the page says that there is none."""
    monkeypatch.setattr(page, "PEERS", tmp_path / "peers.md")
    assert "No comparison" in page.text()
    (tmp_path / "peers.md").write_text(
        "# Peers\n\n| code | rate |\n|---|---|\n| other | 1 |\n\nText\n"
    )
    assert "| other | 1 |" in page.text() and "No comparison" not in page.text()
