"""The engineer's answers on the page: a section for each study, from its own result, or the target
that makes it."""

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

from studies.report.chart import Chart, Picture
from studies.report.markup import Html


class Answer(NamedTuple):
    """A study: ``name`` of its stage, result file, target and of its module here and in
    ``studies.stages``; ``title`` of its section and ``link`` to it."""

    name: str
    title: str
    link: str

    def draw(self, found: dict, figure: Callable[[Chart | Picture, str], Html]) -> Html:
        """What stands in its section; ``figure`` puts a chart and its caption on the page."""
        return import_module(f"studies.report.{self.name}").draw(found, figure)

    def stored(self, study) -> dict | None:
        """Its result, if it was made from the present scene, code and settings."""
        return import_module(f"studies.stages.{self.name}").stored(study)


ANSWERS = (
    Answer("blind", "Agreement on conditions nobody chose", "Blind"),
    Answer("sensitivity", "Which numbers the answer depends on", "Sensitivity"),
    Answer("sweeps", "How large an error may be", "Sweeps"),
    Answer("montecarlo", "Random errors", "Random errors"),
    Answer("limits", "Tolerances that keep limits", "Tolerances"),
    Answer("flight", "After separation", "Flight"),
    Answer("droptest", "Drop tests", "Drop tests"),
    Answer("paper", "The paper's own numbers", "Paper"),
)
