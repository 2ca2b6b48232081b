"""What the terminal shows of a calibration: tables with units, and the files."""

from dataclasses import replace

from typer.testing import CliRunner

from tests.studies import kept
from tipoff.files import read_json
from tipoff.studies.calibration import compliance, compliance_page, page, stage
from tipoff.studies.cli import app
from tipoff.studies.render import document

FIT = kept.result(stage.STAGE)
COMPLIANCE = kept.result(compliance.STAGE)


def shown(found):
    return document.terminal(page.draw(found))


def test_model_error_is_a_column_where_there_is_one():
    """Control: the kept result has none. A condition without residuals has no numbers."""
    assert "with model error" not in shown(FIT)
    ends, residuals = [(500.0, 1700.0)] * 4, FIT.residuals | {"phi60": {}}
    wider = shown(replace(FIT, with_model_error=ends, residuals=residuals))
    assert "with model error" in wider and "500 to 1,700" in wider
    assert any(line.split() == ["phi60", "–", "–", "–"] for line in wider.splitlines())


def test_bounds_and_reasons_are_on_the_page_alone():
    assert "upper bound" in document.markdown(page.draw(FIT))
    assert "upper bound" not in shown(FIT)


def test_a_scene_without_contact_has_no_compliance():
    """Control: the kept result has one."""
    assert "(nm/N)" in document.terminal(compliance_page.draw(COMPLIANCE))
    without = compliance_page.draw(compliance.Compliance())
    assert document.terminal(without) == "No contact: no compliance."


def test_the_compliance_stands_before_the_springs(tmp_path, monkeypatch):
    """With the files of both."""
    both = {
        found.name: found.made(read_json(kept.FOLDER / f"{found.name}.json"))
        for found in (compliance.STAGE, stage.STAGE)
    }
    made = {"compliance": both["compliance"], "springs": both["calibration"]}
    monkeypatch.setattr(stage, "of_models", lambda *_: made)
    asked = ["calibrate", "--scene", "tiny", "--out", str(tmp_path)]
    text = CliRunner().invoke(app, asked, catch_exceptions=False).stdout
    assert text.index("(nm/N)") < text.index("contact.force")
    for name in (COMPLIANCE.file, FIT.calibration):
        assert f"  {tmp_path / 'tiny' / name}" in text.splitlines()
