"""Compute the sensitivity to uncertain inputs: contact constants one at a time, and Sobol' indices;
writes sensitivity.json.

A file of tolerances gives the distribution of an input (vary), or of a factor of its nominal
value (factor):

  \\[factor."friction.dynamic"]
  distribution = "uniform"
  low = "0.75"
  high = "1.25"

  \\[vary."thrust_offset.misalignment.y"]      y and z are components of an offset
  distribution = "normal"
  mean = "0 deg"
  sd = "0.1 deg"

--sweep varies size and direction of misalignment, thrust eccentricity and mass eccentricity, up to 1
deg and 1 mm, or with --vary the errors of a file, up to the size that 99.9 % of its draws stay below. The
result states whether the largest rate about each axis stops growing, and at which size, with an
interval. The sweep is repeated with a thrust that continues after the exit, or ends before it.

  tipoff sensitivity --sweep 120
"""

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result, Section
from tipoff.studies.sensitivity.options import ANGLES, SensitivityOptions


def _answer(request: Request, asked: SensitivityOptions) -> Output:
    asked.require_one()
    if asked.sweep is None:
        from tipoff.studies.sensitivity import page, stage

        return Output.of(stage.run(request.study(), asked), page.draw, request.out)
    from tipoff.studies.sweeps import page as swept
    from tipoff.studies.sweeps import stage as sweeps

    return Output.of(sweeps.run(request.study(), asked), swept.draw, request.out)


def _load() -> Contents:
    from tipoff.studies.sweeps import page, stage

    title, again = "How large an error may be", f"sensitivity --sweep {ANGLES}"
    return Contents(
        (Result(stage.NAME, stage.run, stage.STAGE.stored),),
        (Section.of_stage(stage.STAGE, page.draw, stage.NAME, "Sweeps", title, again),),
    )


ENTRY = Entry((command("sensitivity", __doc__ or "", SensitivityOptions, _answer),), _load)
