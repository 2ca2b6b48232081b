"""Stage ``stability``: hard cases of both fidelities, each with a control: a simpler method that
must fail, else the case proves nothing.

A case is a function without arguments that returns a ``Verdict``.
"""

from dataclasses import dataclass
from pathlib import Path

from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study
from validation.stability import contacts, elastic, guides, thrusts
from validation.stability.verdict import Verdict

CASES = {**contacts.CASES, **guides.CASES, **thrusts.CASES, **elastic.CASES}


@dataclass(frozen=True)
class HardCases:
    """``cases``: a verdict for each; ``failed``: cases that are not held or whose control did not
    fail."""

    cases: tuple[Verdict, ...]
    failed: tuple[str, ...]


def run(study: Study) -> Made[HardCases]:
    """The hard cases."""

    def make() -> tuple[HardCases, list[Path]]:
        found = []
        with Board("stability", len(CASES)) as board:
            for name, case in CASES.items():
                board.callback(name)(0.0)
                found.append(case())
                board.finished(name, "held" if found[-1].held else "NOT held")
        failed = [
            f"{item.name}: {'not held' if not item.held else 'its control did not fail'}"
            for item in found
            if not (item.held and item.control_failed)
        ]
        return HardCases(tuple(found), tuple(failed)), []

    return STAGE.run(study, None, make)


# The cases have their own scenes.
STAGE = Stage("stability", __name__, result=HardCases, of_scene=False)
