"""Sections of the page as tests look at them."""

from collections.abc import Sequence

from tipoff.studies.render import document


def html(parts: Sequence[document.Part]) -> str:
    """The parts as HTML, with name and caption in place of each figure."""
    return str(document.html(parts, lambda chart, words: f"<figure>{chart.name}</figure>{words}"))
