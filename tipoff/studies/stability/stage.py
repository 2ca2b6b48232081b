"""Stage ``stability``: hard cases of both fidelities, each with a control: a simpler method that
must fail, else the case proves nothing.

A case is a function without arguments that returns a ``Verdict``.
"""

from pathlib import Path

from tipoff import sources
from tipoff.studies.stability import contacts, elastic, guides, thrusts
from tipoff.workspace.progress import Board
from tipoff.workspace.study import Study

CASES = {**contacts.CASES, **guides.CASES, **thrusts.CASES, **elastic.CASES}


def run(study: Study) -> dict:
    """``cases``: one verdict each; ``failed``: the cases that are not held or whose control did not
    fail."""

    def make() -> tuple[dict, list[Path]]:
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
        return {"cases": [item._asdict() for item in found], "failed": failed}, []

    # The cases bring their own scenes, so the scene under study is not part of the key.
    return study.stage("stability", sources.digest(__name__), make)
