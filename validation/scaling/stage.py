"""Stage ``scaling``: growth of time with elements, pads and effects (``scaling.growth``), and with length
of the rails, cases and threads (``scaling.trends``), on the condition of the cost study."""

from pathlib import Path

from tipoff.studies.ablation import stage as ablation
from tipoff.studies.cost import stage as cost
from tipoff.workspace import machine
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study
from validation.scaling import growth, trends
from validation.scaling.results import Scaling


def run(study: Study) -> Made[Scaling]:
    """Growth of the run time."""
    name = cost.condition(study)

    def make() -> tuple[Scaling, list[Path]]:
        without = ablation.run(study).result
        found = Scaling(
            condition=name,
            elements=growth.elements(study, name),
            pads=growth.pads(study, name),
            effects=growth.effects(study.condition(name), without),
            trends=trends.measured(study, name),
            hardware=machine.describe(),
        )
        return found, []

    return STAGE.run(study, None, make)


def _inputs(study: Study, _: None) -> list:
    return [cost.condition(study)]


STAGE = Stage("scaling", __name__, inputs=_inputs, result=Scaling)
