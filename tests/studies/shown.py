"""Sections of the page as tests look at them."""

from collections.abc import Sequence
from typing import Any

from tipoff.studies.agreement import stage as compare
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.nominal import stage as nominal
from tipoff.studies.render import document
from tipoff.studies.runs import stage as runs

STAGES = {
    stage.name: stage
    for stage in (*runs.STAGES.values(), compare.STAGE, convergence.STAGE, nominal.STAGE)
}


class Documents(dict):
    """Results of a page, made from documents that a test changes."""

    def get(self, name: str, default: Any = None) -> Any:
        found = super().get(name, default)
        return STAGES[name].made(found) if isinstance(found, dict) else found


def html(parts: Sequence[document.Part]) -> str:
    """The parts as HTML, with name and caption in place of each figure."""
    return str(document.html(parts, lambda chart, words: f"<figure>{chart.name}</figure>{words}"))
