"""The random errors of the paper's Table 3 on the surrogate, checked by the reference."""

from typing import TYPE_CHECKING

from tipoff.studies.montecarlo import command
from tipoff.studies.question import Contents, Entry, Result, Section

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part
    from tipoff.studies.report.page import Page


def _load() -> Contents:
    from tipoff.studies.montecarlo import page, stage, tails, tails_page

    def errors(shown: "Page") -> "list[Part]":
        return shown.shown(stage.NAME, page.draw, stage.NAME)

    def corrected(shown: "Page") -> "list[Part]":
        return shown.shown(tails.NAME, tails_page.draw, f"{stage.NAME} --reference 60")

    return Contents(
        (
            Result(stage.NAME, stage.run, stage.STAGE.stored),
            Result(tails.NAME, tails.run, tails.STAGE.stored),
        ),
        (
            Section(stage.NAME, "Random errors", errors, "Random errors"),
            Section(tails.NAME, "Tails", corrected, "Random errors checked by the reference"),
        ),
    )


ENTRY = Entry((command.montecarlo,), _load)
