"""``tipoff highfi`` and ``tipoff lowfi``."""

from typing import TYPE_CHECKING, Any

from tipoff.studies.commands.options import (
    CheckpointEvery,
    Conditions,
    Resume,
    StepEverything,
)
from tipoff.studies.commands.request import Request, scene_command
from tipoff.studies.commands.running import Output

if TYPE_CHECKING:
    pass


@scene_command()
def highfi(
    request: Request,
    condition: Conditions = None,
    *,
    checkpoint_every: CheckpointEvery = None,
    resume: Resume = True,
    step_everything: StepEverything = False,
) -> Output:
    """Run the finite-element reference on every condition; writes highfi.json and one netCDF file
    for each condition."""
    numerics = {"resume": resume, "step_everything": step_everything}
    return _every(request, "highfi", condition, checkpoint_every=checkpoint_every, **numerics)


@scene_command()
def lowfi(request: Request, condition: Conditions = None) -> Output:
    """Run the surrogate, model compliant, on every condition; writes lowfi.json and one netCDF file
    for each condition."""
    return _every(request, "lowfi", condition)


def _every(
    request: Request, fidelity: str, conditions: list[str] | None, **settings: Any
) -> Output:
    from tipoff.studies.runs import page, stage

    read = stage.STAGES[fidelity].read
    found = stage.run(request.study(conditions, **settings), fidelity)
    return Output(found, lambda found: [page.settled(read(found).conditions)], request.out)
