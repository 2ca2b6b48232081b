"""Writes docs/peers.md and its picture from the results that are part of the project.

python -m validation.documents.peers
"""

import shutil
from pathlib import Path

from tipoff.files import write_text
from tipoff.studies.render.document import Figure, markdown
from validation.documents import state
from validation.peers import page, stage

DOCS = Path(__file__).resolve().parents[2] / "docs"
_TITLE = """# Compared with other codes

Written by `python -m validation.documents.peers` from `validation/peers/kept`; `make peers KEEP=1`
replaces them. `make peers` measures again and prints the same tables. Tests compare today's tipoff with the
kept values of the other codes, also where these are not installed."""


def keep(out: Path) -> None:
    """Keep the results of peers under ``out`` that were run in the project, and write the page."""
    stage.KEPT.mkdir(exist_ok=True)
    for path in sorted((Path(out) / "peers").glob("*.json")):
        shutil.copyfile(path, stage.KEPT / path.name)
    write()


def write() -> None:
    """The page and the picture of the kept results."""
    page.figure(stage.stored(stage.KEPT), DOCS)
    write_text(DOCS / "peers.md", text())


def text() -> str:
    """The page of the kept results."""
    parts = [
        f"![Error over processor time](peers.png)\n\n{part.caption}"
        if isinstance(part, Figure)
        else part
        for part in page.parts(stage.stored(stage.KEPT))
    ]
    results = {
        peer["peer"].lower(): peer for peer in stage.stored(stage.KEPT) if "missing" not in peer
    }
    # Sections of this page, which are subsections in a report.
    sections = f"{markdown(parts)}\n".replace("\n### ", "\n## ")
    return f"{_TITLE}\n\n{state.sentence(results)}\n\n{sections}"


if __name__ == "__main__":
    write()
