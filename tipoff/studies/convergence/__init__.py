"""Estimate the error of the reference from mesh, step, interface stiffness and contact cells;
takes minutes; writes convergence.json."""

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.convergence.options import Options
from tipoff.studies.question import Contents, Entry, Result, Section


def _answer(request: Request, options: Options) -> Output:
    from tipoff.studies.convergence import page, stage

    found = stage.run(request.study(), options)
    return Output.of(found, page.terminal, request.out)


def _load() -> Contents:
    from tipoff.studies.convergence import page, stage

    return Contents(
        (Result("convergence", stage.run, stage.STAGE.stored),),
        (Section("convergence", "Convergence", page.draw, "Error of the reference"),),
    )


ENTRY = Entry((command("convergence", __doc__ or "", Options, _answer),), _load)
