"""Searches for the paper's inputs that take no time, for tests of what is made of their ends."""

import copy
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.studies.shown import html
from tests.studies.synthetic import undrawn
from tipoff import scenes
from tipoff.studies.render import document
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study
from validation import published
from validation.paper import inputs, solutions
from validation.paper import page as section
from validation.paper import stage as paper

BASE = scenes.load("clamped")
COUNT = len(inputs.UNKNOWNS)
SMALL = paper.PaperOptions(
    1, solutions.Plan(points=6, descents=1, pool=1, hops=1, kept=3, steps=(3, 2, 2))
)


def stub(admissible: tuple[int, ...] = (2, 0)):
    """In place of ``solutions.run``: an end at once, each search another, with ``admissible``
    points by stress."""

    def run(launcher_of, stress, seed, plan, progress):
        table = published.sensitivity()
        rates = np.vstack(
            [[0.1, 0.2, 0.4 + seed], table.baseline + 0.01 * (1 + stress), [0.1, 0.1, 0.1]]
        )
        points = np.linspace(0.4, 0.6, admissible[int(stress)])[:, None] * np.ones(COUNT)
        return solutions.Search(
            stress,
            seed,
            np.full(COUNT, 0.5 + 0.01 * stress),
            rates,
            table.changed + 0.0204 * (1 + stress),
            points,
            np.array([[0.005, 0.5], [0.02, 0.3]]),
        )

    return run


def studied(folder: Path, run, options: paper.PaperOptions) -> dict:
    """Result of the stage in ``folder``, with ``run`` in place of a search and figures that are not
    drawn."""
    with pytest.MonkeyPatch.context() as patch:
        undrawn(patch)
        patch.setattr(solutions, "run", run)
        return paper.run(Study(BASE, folder, Settings(workers=1)), options).document


def copied(made: tuple[Path, dict], folder: Path) -> tuple[Study, dict]:
    """A study in ``folder`` with the files and the result of another one."""
    shutil.copytree(made[0], folder, dirs_exist_ok=True)
    return Study(BASE, folder, Settings(workers=1)), copy.deepcopy(made[1])


def page(found: dict) -> str:
    """The section of a result, with captions in place of its figures."""
    return html(section.draw(found))


def shown(found: dict) -> str:
    """What the command prints of a result."""
    return document.terminal(section.draw(found))
