"""Stage ``stability``: hard cases of both fidelities, each with a simpler method that fails."""

from pathlib import Path

from tipoff import sources
from tipoff.studies.core.progress import Board
from tipoff.studies.core.study import Study
from tipoff.studies.stability import cases


def run(study: Study) -> dict:
    """``cases``: one verdict each; ``failed``: the cases that are not held or whose control did not
    fail."""

    def make() -> tuple[dict, list[Path]]:
        found = []
        listed = cases.cases()
        with Board("stability", len(listed)) as board:
            for name, case in listed.items():
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
