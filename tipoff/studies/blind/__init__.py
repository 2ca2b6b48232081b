"""Compare the surrogates with the reference on fitted and held-out conditions: agreement, floor,
speed-up; writes agreement.json.

With --blind the conditions are drawn at random, after all constants are fixed. tipoff curves
compares files of other codes.

  tipoff compare --neighbours 64
  tipoff compare --blind 8
"""

from tipoff.studies.agreement.options import CASES, CompareOptions
from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result, Section


def _answer(request: Request, asked: CompareOptions) -> Output:
    if asked.cases is not None:
        from tipoff.studies.blind import page as drawn
        from tipoff.studies.blind import stage as blind

        return Output.of(blind.run(request.study(), asked), drawn.draw, request.out)
    from tipoff.studies.agreement import page, stage

    _require(asked)
    return Output.of(stage.run(request.study(), asked), page.draw, request.out)


def _require(asked: CompareOptions) -> None:
    """Raise SceneError for options that would have no effect, every fault listed."""
    from tipoff.faults import Fault, SceneError

    given = {"--vary": asked.vary, "--seed": asked.seed}
    faults = [
        Fault(name, "option", str(value), "--blind for this option")
        for name, value in given.items()
        if value is not None
    ]
    if faults:
        raise SceneError(faults)


def _load() -> Contents:
    from tipoff.studies.blind import page, stage

    title, again = "Agreement on blind conditions", f"compare --blind {CASES}"
    return Contents(
        (Result(stage.NAME, stage.run, stage.STAGE.stored),),
        (Section.of_stage(stage.STAGE, page.draw, stage.NAME, "Blind", title, again),),
    )


ENTRY = Entry((command("compare", __doc__ or "", CompareOptions, _answer),), _load)
