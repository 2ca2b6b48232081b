"""A study as the command line and the page see it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import typer

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part


class Parts(NamedTuple):
    """What a study does. ``run`` makes its result; ``stored`` finds it, if it was made from the
    present scene, code and settings; ``draw`` gives the parts of its section of the page."""

    run: Callable[["Study"], dict]
    stored: Callable[["Study"], dict | None]
    draw: Callable[[dict], "list[Part]"]


@dataclass(frozen=True)
class Question:
    """One study.

    ``name``: of its command, stage, result file and make target. ``title``: of its section.
    ``link``: words that lead to the section. ``add_command``: puts the command under the
    application. ``load``: imports the modules that do the work, which ``--help`` does not wait for.
    """

    name: str
    title: str
    link: str
    add_command: Callable[[typer.Typer], None]
    load: Callable[[], Parts]
