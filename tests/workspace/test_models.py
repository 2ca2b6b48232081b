"""Models by name: the default, options that belong to another model, and what an answer says of its
model."""

import json
import math
from dataclasses import replace
from typing import get_args

import pytest
from typer.testing import CliRunner

from tests.scenes.test_calibration import CALIBRATION
from tests.studies.agreement.made import ROW, table
from tipoff import scenes
from tipoff.faults import SceneError
from tipoff.lowfi import Numerics
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, MODELS, SPRINGS, SURROGATES
from tipoff.studies.agreement import kept
from tipoff.studies.cli import app
from tipoff.studies.commands import options
from tipoff.studies.single import single
from tipoff.workspace import models
from tipoff.workspace.settings import defaults
from tipoff.workspace.store import Store
from tipoff.workspace.study import Study, StudyError, numerics_faults

UNKNOWN = replace(
    ROW,
    condition="h8",
    reference_converged=False,
    judgement="cannot be judged",
    verdict="cannot be judged: reference not converged",
)
TABLE = table(compliant=(ROW, UNKNOWN), fitted=(replace(ROW, settled_rate_error_deg_s=0.14),))


def call(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def study(tmp_path):
    return Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))


def test_a_model_that_does_not_settle_has_no_error_there(study, monkeypatch):
    lost = replace(ROW, condition="h1", settled_rate_error_deg_s=None, judgement="misses")
    for rows, said in (
        ([ROW, lost], "at most 0.012 deg/s from the reference on 1 condition"),
        ([lost], "it does not settle on 1 where the reference does"),
    ):
        found = replace(TABLE, compliant=rows)
        monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _, found=found: found)
        words = kept.words(study, COMPLIANT)
        assert said in words and "does not settle on 1" in words


def test_what_could_not_be_judged_is_not_called_unmeasured(study, monkeypatch):
    """Control: without a table it is not measured, and the command that measures it is named."""
    lost = replace(ROW, condition="h8", judgement="cannot be judged")
    for rows, said in (
        (
            [lost],
            "could judge none of 1 condition with contact by single runs; h8 cannot be judged",
        ),
        ([replace(ROW, touches=False)], "no pad touches on any of 1 compared condition"),
    ):
        found = replace(TABLE, compliant=rows)
        monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _, found=found: found)
        words = kept.words(study, COMPLIANT)
        assert words.startswith("not known: ") and said in words
    monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: None)
    assert "tipoff compare measures it" in kept.words(study, COMPLIANT)


def test_the_error_is_that_of_the_same_numerics_and_constants(study, monkeypatch):
    """Those that tipoff compare used. Control: they have an error."""
    monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: TABLE)
    monkeypatch.setattr(
        "tipoff.studies.calibration.stage.constants", lambda _: CALIBRATION.constants
    )
    assert "0.012 deg/s" in kept.words(study, COMPLIANT, ROW.condition)
    words = kept.words(study, COMPLIANT, ROW.condition, numerics="degree 1 and 4 cells")
    assert words.startswith("not measured with degree 1 and 4 cells")
    assert single.own_numerics(Numerics(degree=1, cells=4)) == "degree 1 and 4 cells"
    assert single.own_numerics(Numerics(degree=3)) == single.own_numerics(Numerics()) == ""
    assert "0.14 deg/s" in kept.words(study, SPRINGS, ROW.condition, CALIBRATION)
    others = replace(CALIBRATION, constants={"contact.clearance": 3e-4})
    assert kept.words(study, SPRINGS, None, others).startswith("not measured with these constants")


def test_the_command_line_has_the_names_of_the_models():
    assert get_args(options.ModelName) == MODELS
    assert get_args(options.SurrogateName) == SURROGATES


@pytest.mark.parametrize(
    "given, fault",
    [
        (
            ["--model", "finite-elements", "--calibration", "c.toml"],
            "--calibration: given c.toml, expected none with --model finite-elements: it is an "
            "option of compliant and springs",
        ),
        (
            ["--model", "finite-elements", "--modes", "4"],
            "--modes: given 4, expected none with --model finite-elements",
        ),
        (["--model", "springs", "--modes", "4"], "option of compliant"),
        (["--model", "springs", "--cells", "16"], "--cells: given 16, expected none with --model"),
        (["--modes", "21", "--cells", "16"], "--modes: value: given 21, expected a whole"),
        (["--checkpoint-every", "5 s"], "option of finite-elements"),
        (["--modes", "21"], "a whole number from 0 to 20"),
    ],
)
def test_options_of_another_model_are_bad_input(tmp_path, given, fault):
    result = call("run", "--scene", "tiny", *given, "--out", tmp_path / "out")
    assert result.exit_code == 2 and fault in result.stderr.replace(
        "option: given", "given"
    ).replace("  ", " "), result.stderr
    assert not (tmp_path / "out").exists()


def test_every_fault_of_the_options_is_listed():
    with pytest.raises(SceneError) as refused:
        models.require(models.ModelOptions(FINITE_ELEMENTS, "c.toml", 4))
    assert [fault.source for fault in refused.value.faults] == ["--calibration", "--modes"]


def test_an_answer_names_its_model_and_its_error(tmp_path):
    """Compliant contact without a word; the second run finds the compliance where the first one
    kept it."""
    asked = ("run", "--scene", "tiny", "--condition", "phi15", "--out", tmp_path)
    first = call(*asked, "--explain")
    assert first.exit_code == 0, first.output
    assert "tiny / phi15, model compliant: exited" in first.stdout
    assert (
        "agreement     not measured for this scene with this code (tipoff compare measures it)"
        in first.stdout
    )
    assert first.stderr.count("rail compliance, once per rail and pads") == 1
    assert "  rail mesh     moves a rate by 0.22 deg/s. rail compliance at 8 mm" in first.stdout
    short = call(*asked).stdout
    assert set(short.splitlines()) < set(first.stdout.splitlines())
    assert "  rate          5.0, 2.0, 9.0 ± 0.2 deg/s (x, y, z), 10.5 in total\n" in short
    assert "  error         mostly by the rail mesh, 0.22 deg/s; " in short
    again = json.loads(call(*asked, "--json").stdout)
    squares = sum(part**2 for part in again["error"]["parts_deg_s"].values())
    assert again["error"]["rate_deg_s"] == pytest.approx(squares**0.5, rel=1e-12)
    assert again["rail_compliance"]["element_size_m"] == 8e-3
    assert again["rail_compliance"]["words"] in first.stdout
    assert again["model"] == COMPLIANT
    vibrating = call(*asked, "--modes", "1")
    assert (
        "model compliant, 1 mode of each rail" in vibrating.stdout
        and "rail compliance" not in vibrating.stderr
    )
    finer = json.loads(call(*asked, "--cells", "10", "--json").stdout)
    assert finer["model"] == COMPLIANT and finer["settled"] != again["settled"]
    springs = json.loads(call(*asked, "--model", "springs", "--json").stdout)
    assert springs["model"] == SPRINGS and springs["settled"] != again["settled"]


def test_the_error_comes_from_the_agreement_table(study, monkeypatch):
    monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: TABLE)
    assert kept.words(study, COMPLIANT, "phi15") == (
        "settled rates within 0.012 deg/s of the reference, curves within 0.33 %"
    )
    assert kept.words(study, COMPLIANT, "h8").endswith("but the reference is not converged there")
    assert kept.words(study, COMPLIANT) == (
        "at most 0.012 deg/s from the reference on 1 condition where that is converged and "
        "pads touch"
    )
    monkeypatch.setattr(
        "tipoff.studies.calibration.stage.constants", lambda _: CALIBRATION.constants
    )
    assert "0.14 deg/s" in kept.words(study, SPRINGS, "phi15", CALIBRATION)
    assert kept.words(study, SPRINGS, "phi15").startswith("not measured")
    assert kept.words(study, COMPLIANT, "phi15", modes=2).startswith("not measured")
    said = kept.words(study, COMPLIANT, "phi15", CALIBRATION)
    assert (
        said == "not measured: the agreement table has compliant contact with the scene's constants"
    )
    assert kept.words(study, FINITE_ELEMENTS, "phi15") == "the reference itself"


def test_a_run_is_not_answered_by_a_model_that_its_agreement_rejects(study, monkeypatch):
    """Controls: the same condition by name; one whose reference is not converged."""
    wrong = replace(ROW, judgement="misses", verdict="misses: rate L2 2 x limit")
    missed = replace(TABLE, compliant=(wrong, UNKNOWN))
    monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: missed)
    monkeypatch.setattr(single, "result_of", lambda *_: {"made": True})
    monkeypatch.setattr(Study, "rail_compliance", lambda *_, **__: None)
    with pytest.raises(StudyError, match="phi15: misses: rate L2 2 x limit"):
        single.run(replace(study, only=("phi15",)), "phi15")
    assert single.run(study, "phi15", models.ModelOptions(COMPLIANT)) == {"made": True}
    kept.require_accepted(study, None, "h8")


@pytest.mark.parametrize(
    "judgement, said",
    [
        ("agrees as distribution", "; 1 more agree as distributions"),
        ("cannot be judged", ""),
        ("misses", "; as distributions it misses h8"),
    ],
)
@pytest.mark.parametrize("converged", [True, False])
def test_a_chaotic_condition_rejects_the_default_model_where_its_own_distribution_misses(
    study, monkeypatch, judgement, said, converged
):
    """On that condition and nowhere else. Its curve misses the gates in every case. Control: as a curve
    the same miss rejects the model for the whole scene."""
    chaotic = replace(
        UNKNOWN,
        reference_converged=converged,
        judged_as="distribution",
        judgement=judgement,
        verdict=judgement,
    )

    def compared(row):
        found = replace(TABLE, compliant=(ROW, row))
        monkeypatch.setattr("tipoff.studies.agreement.stage.stored", lambda _: found)

    compared(chaotic)
    for condition in (None, "phi15"):
        kept.require_accepted(study, None, condition)
    if judgement == "misses":
        with pytest.raises(StudyError, match="h8: misses"):
            kept.require_accepted(study, None, "h8")
    else:
        kept.require_accepted(study, None, "h8")
    words = kept.words(study, COMPLIANT)
    assert words.endswith(f"where that is converged and pads touch{said}")
    assert kept.words(study, COMPLIANT, "h8").endswith(f"it {judgement}")
    compared(replace(chaotic, judged_as="curve", judgement="misses"))
    with pytest.raises(StudyError, match="h8: "):
        kept.require_accepted(study, None)


def test_bad_numerics_are_faults_of_their_options():
    """Each once, with its own value. The text of the exception was the expected value of one fault."""
    with pytest.raises(ValueError) as caught:
        Numerics(relative_tolerance=1.0, modes=25)
    assert list(map(str, numerics_faults(caught.value))) == [
        "--tolerance: value: given 1.0, expected 1e-13 to 0.01",
        "--modes: value: given 25, expected a whole number from 0 to 20, or 'auto'",
    ]


@pytest.mark.parametrize(
    "took, is_there, says", [(10.0, False, 1), (10.0, True, 0), (0.1, False, 0)]
)
def test_a_long_run_has_its_answer_before_the_runs_for_its_error(
    study, monkeypatch, capsys, took, is_there, says
):
    """Controls: an error that is there, and a short run."""

    class Interrupted(Exception):
        pass

    def interrupt(*_given):
        raise Interrupted

    request = study.lowfi("phi15")
    found = study.store.get(request)
    assert found.outcome.rate is not None
    found.cost["wall_s"] = took
    monkeypatch.setattr(Store, "get", lambda *_: found)
    monkeypatch.setattr(single.disturbed, "kept", interrupt)
    if is_there:
        study.store.path(request).with_suffix(".error.json").write_text("{}")
    capsys.readouterr()
    with pytest.raises(Interrupted):
        single.result_of(study, "phi15", request, single.Detail.ANSWER)
    said = capsys.readouterr().err
    assert said.count("deg/s (x, y, z), settled; its error takes") == says
    x = math.degrees(found.outcome.rate[0])
    assert not says or f"  rate {x:.3g}, " in said
