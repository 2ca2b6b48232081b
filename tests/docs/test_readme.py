"""README: short enough to be read, no dead link, and figures that are those of the results."""

import re
from dataclasses import replace

import pytest

from tests.docs import pages
from tests.studies.agreement import made
from tests.studies.agreement.made import ROW
from tipoff.files import write_json
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.workspace import machine
from validation.documents import readme, state

TEXT = (pages.ROOT / "README.md").read_text(encoding="utf-8")


def _row(judgement: str, curve: float = 0.001, settled: float = 0.01, **other) -> JudgedCondition:
    errors = {"rate_relative_l2": curve, "settled_rate_error_deg_s": settled}
    return replace(ROW, judgement=judgement, **errors, **other)


def _written(folder, rows: list[JudgedCondition]) -> str:
    write_json(folder / "agreement.json", made.document(compliant=rows))
    return readme.headline(folder)


def _of_agreement(said: str) -> str:
    return said.split("\n- **Speed**")[0]


def test_it_fits_on_three_screens():
    assert len(TEXT.splitlines()) <= 120


@pytest.mark.parametrize("page", pages.PAGES)
def test_every_link_to_a_file_leads_to_one(page):
    text = (pages.ROOT / page).read_text(encoding="utf-8")
    files = {link.split("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text) if ":" not in link}
    assert not [link for link in files if link and not ((pages.ROOT / page).parent / link).exists()]


def test_conditions_are_counted_by_their_verdict(tmp_path):
    said = _written(
        tmp_path,
        [
            _row(verdicts.AGREES, 0.002, 0.03),
            _row(verdicts.AGREES, 0.004, 0.01),
            _row(verdicts.AGREES, 1e-8, 1e-8, touches=False),
            _row(verdicts.MISSES, 0.1, 0.5),
            _row(verdicts.CANNOT, 0.2, 3.0),
            _row(verdicts.AS_DISTRIBUTION, 0.3, 3.0, judged_as=verdicts.DISTRIBUTION),
            _row(verdicts.MISSES, 0.4, 3.0, judged_as=verdicts.DISTRIBUTION),
            _row(verdicts.MISSES, 0.4, 3.0, judged_as=verdicts.DISTRIBUTION),
        ],
    )
    assert "converged on 4 of 8 conditions" in said and "agrees on 3 of these 4" in said
    assert "On 3 others" in said and _of_agreement(said).endswith(
        "1 agree, 2 miss, 0 cannot be judged."
    )
    assert "183 times" in said and said.endswith(" ms on compliant contact.")
    assert "Pads touch in 2 of the 3" in said
    assert "at most 0.4 %" in said and "at most 0.03 deg/s" in said


def test_agreement_in_free_flight_alone_has_no_error_of_contact(tmp_path):
    said = _written(tmp_path, [_row(verdicts.AGREES, 1e-8, 1e-8, touches=False)])
    assert _of_agreement(said).endswith("agrees on 1 of these 1.")


def test_figures_are_those_of_the_page_of_results():
    """Both are written from the same files; one that was written without the other shows here."""
    results = (pages.ROOT / "docs/results.md").read_text(encoding="utf-8")
    table = results.split("\n\nCompliant contact at other values")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in re.findall(r"^\|.*\|$", table, re.MULTILINE)[2:]
    ]
    verdicts_of_curves = [verdict for *_, judged_as, verdict in rows if judged_as == "curve"]
    judged = [said for said in verdicts_of_curves if not said.startswith("reference not")]
    agree = sum(said.startswith("agrees") for said in judged)
    assert f"converged on {len(judged)} of {len(rows)} conditions" in TEXT
    assert f"agrees on {agree} of these {len(judged)}" in TEXT
    (speed,) = re.findall(r"\*\*Speed\*\* on equal elements: (.*)\.$", TEXT, re.MULTILINE)
    assert speed in results
    equal = re.findall(r"\*\*Speed-up\*\* (.*)\.$", TEXT, re.MULTILINE)
    assert all(said in results for said in equal)


@pytest.mark.parametrize("name, page", [("results", "results"), ("tails", "tails")])
def test_numbers_are_of_the_state_of_their_page(name, page):
    """README and the page are written from one file; numbers of another state show here."""
    (made,) = re.findall(f"<!-- {name}, state (.*): python -m", TEXT)
    assert made in (pages.ROOT / f"docs/{page}.md").read_text(encoding="utf-8").split("\n|")[0]


def test_a_page_names_each_state_of_its_results():
    made = machine.state()
    other = made | {"commit": "0123456789ab", "version": "2.0"}
    one = state.sentence({"highfi": {"state": made}, "lowfi": {"state": made}, "blind": None})
    assert one == f"State: {machine.stated(made)}." and made["date"] in one
    two = state.sentence({"highfi": {"state": made}, "lowfi": {"state": other}, "cost": {}})
    assert "`lowfi.json`: tipoff 2.0, commit 0123456789ab, " in two
    assert "`cost.json`: not recorded" in two and machine.stated(made) in two
    assert machine.stated(other) in state.mark("tails", {"state": other})
