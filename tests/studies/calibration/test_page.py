"""What the terminal shows of a calibration: tables with units, and the files."""

from dataclasses import replace

from tests.studies import kept
from tipoff.studies.calibration import compliance, page, stage
from tipoff.studies.render import document

FIT = kept.result(stage.STAGE)
COMPLIANCE = kept.result(compliance.STAGE)


def shown(found, tmp_path):
    return document.terminal(page.terminal(found, tmp_path))


def test_model_error_is_a_column_where_there_is_one(tmp_path):
    """Control: the kept result has none. A condition without residuals has no numbers."""
    assert "with model error" not in shown(FIT, tmp_path)
    ends, residuals = [(500.0, 1700.0)] * 4, FIT.residuals | {"phi60": {}}
    wider = shown(replace(FIT, with_model_error=ends, residuals=residuals), tmp_path)
    assert "with model error" in wider and "500 to 1,700" in wider
    assert any(line.split() == ["phi60", "–", "–", "–"] for line in wider.splitlines())


def test_the_compliance_stands_before_the_springs(tmp_path):
    both = {"compliance": COMPLIANCE, "springs": FIT}
    text = document.terminal(page.of_models(both, tmp_path))
    assert text.index("(nm/N)") < text.index("contact.force")
    assert f"  {tmp_path / COMPLIANCE.file}" in text.splitlines()
    without = {"compliance": compliance.Compliance()}
    assert document.terminal(page.of_models(without, tmp_path)) == "no contact: no compliance"
