"""The record of a study: its command, its results, its sections of the page."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part
    from tipoff.studies.report.page import Page
    from tipoff.workspace.study import Study


class Result(NamedTuple):
    """A result of a study, from one result file or several, under its ``name`` on the page.

    ``run`` makes it. ``stored`` finds it if it was made from the present scene, code and settings.
    The report makes each result without ``stored``. It shows a result with ``stored`` where there
    is one; with ``tipoff report --every`` it makes it too if it has ``run``.
    """

    name: str
    run: Callable[["Study"], dict] | None = None
    stored: Callable[["Study"], Any] | None = None


class Section(NamedTuple):
    """A section of the page.

    ``anchor``: its id in HTML. ``link``: the text of the link to it. ``draw``: makes its parts,
    empty where there is nothing to show. ``title``: its heading.
    """

    anchor: str
    link: str
    draw: Callable[["Page"], "Sequence[Part]"]
    title: str


class Contents(NamedTuple):
    """The results and sections of a study."""

    results: tuple[Result, ...] = ()
    sections: tuple[Section, ...] = ()


@dataclass(frozen=True)
class Entry:
    """One study in the registry: its ``commands``, named as their functions. ``load`` imports the
    modules that do the work; ``--help`` does not call it."""

    commands: tuple[Callable[..., None], ...]
    load: Callable[[], Contents] = Contents


class Parts(NamedTuple):
    """The functions of a study with one result, of which ``run`` and ``stored`` are those of its
    ``Result``; ``draw`` makes the parts of its section."""

    run: Callable[["Study"], dict]
    stored: Callable[["Study"], dict | None] | None
    draw: Callable[[dict], "list[Part]"]


class Question(Entry):
    """A study with one result and one section.

    ``name``: of its command, stage, result file and make target. ``title``: of its section.
    ``link``: the text of the link to the section. ``load``: imports the modules that do the work.
    """

    def __init__(
        self,
        name: str,
        title: str,
        link: str,
        command: Callable[..., None],
        load: Callable[[], Parts],
    ):
        def contents() -> Contents:
            run, stored, draw = load()

            def section(page: "Page") -> "list[Part]":
                return page.shown(name, draw, name)

            return Contents((Result(name, run, stored),), (Section(name, link, section, title),))

        super().__init__((command,), contents)
