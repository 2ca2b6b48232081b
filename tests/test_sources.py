"""What code a module depends on: an edit of words changes nothing, an edit of code all that rests
on it."""

import shutil
from pathlib import Path

import pytest

from tipoff import sources

ROOT = Path(__file__).resolve().parent.parent
SOLVERS = (
    "tipoff.highfi",
    "tipoff.lowfi",
    "tipoff.lowfi.dynamics.integrate",
    "tipoff.highfi.dynamics.step",
)


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A copy of the project whose files may be edited, and a fresh memory of it."""
    shutil.copytree(
        ROOT / sources.PACKAGE,
        tmp_path / sources.PACKAGE,
        ignore=lambda _, names: set(names) - _code(names),
    )
    monkeypatch.setattr(sources, "ROOT", tmp_path)
    forget()
    yield tmp_path
    forget()


def _code(names):
    return {name for name in names if name.endswith(".py") or "." not in name} - {"__pycache__"}


def forget():
    """Let digests be taken anew, as another process would."""
    sources.digest.cache_clear()
    sources.source.cache_clear()
    sources.used_by.cache_clear()
    sources.path.cache_clear()


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    forget()


def digests(*modules: str) -> list[str]:
    return [sources.digest(module) for module in modules]


def test_docstrings_comments_and_layout_do_not_count(project):
    law, before = project / "tipoff" / "mechanics" / "laws" / "friction.py", digests(*SOLVERS)
    edit(law, '"""', '"""Other words. ')
    edit(law, "\n\n\n", "\n\n\n# a remark\n\n\n")
    assert digests(*SOLVERS) == before


def test_a_constant_of_the_friction_law_counts_wherever_the_law_is_used(project):
    law, before = (
        project / "tipoff" / "mechanics" / "laws" / "friction.py",
        digests(*SOLVERS, "tipoff.kernels.rotation"),
    )
    edit(law, "3.0", "3.0000001")
    after = digests(*SOLVERS, "tipoff.kernels.rotation")
    assert all(a != b for a, b in zip(before[:-1], after[:-1]))
    assert before[-1] == after[-1]


def test_one_solver_does_not_depend_on_the_other(project):
    before = digests(*SOLVERS)
    edit(
        project / "tipoff" / "lowfi" / "dynamics" / "step.py",
        "_SAFETY, _SHRINK, _GROW = 0.9",
        "_SAFETY, _SHRINK, _GROW = 0.8",
    )
    after = digests(*SOLVERS)
    assert [a == b for a, b in zip(before, after)] == [True, False, False, True]


@pytest.mark.parametrize(
    "line, depends",
    [
        (
            "import tipoff.lowfi.dynamics.integrate",
            {"tipoff", "tipoff.lowfi.dynamics.integrate"},
        ),
        ("from tipoff.lowfi.dynamics import integrate", {"tipoff.lowfi.dynamics.integrate"}),
        ("from tipoff.lowfi.dynamics.integrate import Plan", {"tipoff.lowfi.dynamics.integrate"}),
        (
            "def late():\n    from tipoff.lowfi.dynamics import integrate",
            {"tipoff.lowfi.dynamics.integrate"},
        ),
        ("import numpy.random", set()),
        ("if TYPE_CHECKING:\n    from tipoff.lowfi.dynamics import integrate", set()),
    ],
)
def test_forms_of_imports(project, line, depends):
    package = project / "tipoff"
    (package / "scenes" / "other.py").write_text("from typing import TYPE_CHECKING\n" + line + "\n")
    for module in ("lowfi/dynamics/integrate", "__init__"):
        (package / f"{module}.py").write_text("Plan = 1\n")
    forget()
    assert set(sources.closure("tipoff.scenes.other")) == {"tipoff.scenes.other", *depends}


def test_a_module_that_is_not_there(project):
    with pytest.raises(ModuleNotFoundError, match=r"no module tipoff\.scenes\.nothing"):
        sources.digest("tipoff.scenes.nothing")


STAGES = [
    f"tipoff.studies.{name}.stage"
    for name in ("runs", "agreement", "cost", "limits", "convergence")
]


def page() -> str:
    return sources.digest("tipoff.studies.report.stage")


def test_the_look_of_the_page_makes_only_the_page_again(project):
    before, drawn = digests(*STAGES, *SOLVERS), page()
    edit(
        project / "tipoff" / "studies" / "render" / "style.py", "font-size: 30px", "font-size: 31px"
    )
    assert digests(*STAGES, *SOLVERS) == before
    assert page() != drawn


def test_a_law_makes_every_stage_again_that_rests_on_it(project):
    before = digests(*STAGES)
    edit(project / "tipoff" / "mechanics" / "laws" / "friction.py", "3.0", "3.0000001")
    assert not set(digests(*STAGES)) & set(before)


def test_one_study_does_not_make_another_again(project):
    before = digests(*STAGES)
    edit(project / "tipoff" / "studies" / "limits" / "stage.py", "NAME = ", "OTHER, NAME = 1, ")
    changed = [a != b for a, b in zip(before, digests(*STAGES))]
    assert [name.split(".")[-2] for name, new in zip(STAGES, changed) if new] == ["limits"]


RUNS = ("tipoff.highfi", "tipoff.lowfi", "tipoff.calibration.rail_compliance")


def runs() -> list[str]:
    """What the keys of runs have of the code."""
    return [sources.of_runs(module) for module in RUNS]


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("formats/sections/dxf.py", "LINE, ARC and LWPOLYLINE are read", "Other words"),
        ("formats/thrusts/rasp.py", "raise ValueError", "raise TypeError"),
        ("scenes/suggestions.py", "def ", "def _other(): pass\n\n\ndef "),
        ("results/unfinished.py", "stuck on the rail", "held"),
        ("scenes/effects/thermal.py", "Mean change of temperature", "Other words"),
        ("scenes/effects/friction.py", '"""', '"""Other words. '),
    ],
)
def test_words_and_readers_forget_no_run(project, file, old, new):
    """What a reader makes of a file is part of the hash of a scene. The stages that show it are made
    again."""
    before = runs()
    edit(project / "tipoff" / file, old, new)
    assert runs() == before


@pytest.mark.parametrize(("room", "forgotten"), [("meshes", RUNS[::2]), ("thrusts", ())])
def test_a_new_format_is_code_of_runs_without_an_import(project, room, forgotten):
    """A file in the folder of meshes, whose elements no hash of a scene has. Control: a thrust, whose
    values it has."""
    before = dict(zip(RUNS, runs()))
    (project / "tipoff" / "formats" / room / "another.py").write_text("FORMATS = ()\n")
    forget()
    after = dict(zip(RUNS, runs()))
    assert [module for module in RUNS if after[module] != before[module]] == list(forgotten)


@pytest.mark.parametrize(
    ("file", "old", "new", "forgotten"),
    [
        ("mechanics/laws/friction.py", "3.0", "3.0000001", RUNS),
        ("mechanics/laws/thrust.py", "-0.5 * x", "-0.6 * x", RUNS),
        ("scenes/effects/thermal.py", "0.5 * (rail.start", "0.6 * (rail.start", RUNS),
        ("scenes/effects/spring.py", "last = max(self.preload", "last = min(self.preload", RUNS),
        ("scenes/scene_model.py", "pad.length / 2", "pad.length / 3", RUNS),
        ("mechanics/estimates/ends.py", "_MARGIN = 1.25", "_MARGIN = 1.5", RUNS),
        ("formats/outline.py", "SAME = ", "OTHER = SAME = ", RUNS),
        ("lowfi/dynamics/step.py", "_GROW = 0.9", "_GROW = 0.8", RUNS[1:2]),
    ],
)
def test_what_determines_numbers_forgets_runs(project, file, old, new, forgotten):
    """Control of the readers: a law, how a table becomes its record, and an estimate of the end."""
    before = dict(zip(RUNS, runs()))
    edit(project / "tipoff" / file, old, new)
    after = dict(zip(RUNS, runs()))
    assert [module for module in RUNS if after[module] != before[module]] == list(forgotten)


def test_readers_are_modules_whose_results_solvers_do_not_use():
    """A solver names of a reader only the class of an error and its words."""
    assert all(sources.path(name) for name in sources.READERS)
    kept = set(sources.closure(*RUNS, without=sources.READERS))
    beyond = {
        (name, reader)
        for name in kept
        if name.split(".")[1] in ("highfi", "lowfi", "calibration", "mechanics", "kernels")
        for reader in sources.used_by(name) - kept
    }
    assert {reader for _, reader in beyond} == {"tipoff.faults"}
