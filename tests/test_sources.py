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
    for name in ("runs", "agreement", "cost", "limits", "stability", "convergence")
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
