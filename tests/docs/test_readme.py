"""README: short enough to be read, no dead link, and figures that are those of the results."""

import re
from dataclasses import replace

import pytest

from tests.docs import pages
from tests.studies.agreement import made
from tests.studies.agreement.made import ROW
from tipoff.files import read_json, write_json
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


def test_the_speed_at_equal_accuracy_is_a_bound_unless_a_mesh_is_surer():
    said = made.EQUAL.short()
    assert "on phi35 the ratio is 183: 250 s with elements of 1 mm against 5 ms" in said
    assert "is at least 183: " in replace(made.EQUAL, surer=False).short()


def test_the_page_of_results_has_the_speed_at_equal_accuracy_once():
    text = (pages.ROOT / "docs/results.md").read_text(encoding="utf-8")
    assert text.lower().count("speed-up at equal accuracy") == 1 == TEXT.count("At equal accuracy")


def test_agreement_in_free_flight_alone_has_no_error_of_contact(tmp_path):
    said = _written(tmp_path, [_row(verdicts.AGREES, 1e-8, 1e-8, touches=False)])
    assert _of_agreement(said).endswith("agrees on 1 of these 1.")


def test_pages_are_those_of_the_kept_results():
    """So README, its pages, and the code that writes them are of one state. The results were written by this
    version or one before, and are read."""
    written = readme.texts()
    assert written.keys() >= {pages.ROOT / "README.md", pages.ROOT / "docs/results.md"}
    for page, text in written.items():
        assert page.read_text(encoding="utf-8") == text, page


def test_a_part_that_was_made_again_replaces_what_is_kept(tmp_path, monkeypatch):
    """Control: a part that was not made again, and one that is damaged, stay."""
    monkeypatch.setattr(readme, "KEPT", tmp_path / "kept")
    first, second = tmp_path / "first", tmp_path / "second"
    for name in ("agreement", "blind"):
        write_json(first / "reference" / f"{name}.json", {"made": name})
    write_json(second / "reference" / "blind.json", {"made": "again"})
    (second / "reference" / "agreement.json").write_text("{}")
    for results in (first, second):
        readme.keep(results)
    found = {path.stem: read_json(path)["made"] for path in (tmp_path / "kept").rglob("*.json")}
    assert found == {"agreement": "agreement", "blind": "again"}


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
