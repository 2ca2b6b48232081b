"""Sensitivity to uncertain inputs: contact constants one at a time, and Sobol' indices. The command is
that of ``studies.sweeps``."""

from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.sensitivity import page, stage

    title = "Sensitivity to uncertain inputs"
    return Contents(
        (Result(stage.NAME, stage.run, stage.STAGE.stored),),
        (Section.of_stage(stage.STAGE, page.draw, stage.NAME, "Sensitivity", title),),
    )


ENTRY = Entry((), _load)
