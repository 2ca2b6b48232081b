"""A study as the command line and the page see it: its command, its result files, its sections."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

if TYPE_CHECKING:
    from tipoff.studies.core.study import Study
    from tipoff.studies.render.document import Part
    from tipoff.studies.render.markup import Html
    from tipoff.studies.report.page import Page


class Result(NamedTuple):
    """A result file, or what there is of several, under the ``name`` that the page has for it.

    ``run`` makes it; ``stored`` finds it, if it was made from the present scene, code and settings.
    The report makes a result that has no ``stored``, and only shows one that has no ``run``. One
    that has both is shown where it was made, and made with ``tipoff report --every``.
    """

    name: str
    run: Callable[["Study"], dict] | None = None
    stored: Callable[["Study"], Any] | None = None


class Section(NamedTuple):
    """A section of the page. ``anchor``: its identity in HTML. ``link``: words that lead to it.
    ``draw``: the whole section, or nothing where it has nothing to show."""

    anchor: str
    link: str
    draw: Callable[["Page"], "Html"]


class Contents(NamedTuple):
    """The results and sections of a study."""

    results: tuple[Result, ...] = ()
    sections: tuple[Section, ...] = ()


@dataclass(frozen=True)
class Entry:
    """One study in the registry. ``add_command`` puts its commands under the application. ``load``
    imports the modules that do the work, which ``--help`` does not wait for."""

    add_command: Callable[[typer.Typer], None]
    load: Callable[[], Contents] = Contents


class Parts(NamedTuple):
    """What a study with one result does; ``draw`` gives the parts of its section."""

    run: Callable[["Study"], dict]
    stored: Callable[["Study"], dict | None]
    draw: Callable[[dict], "list[Part]"]


class Question(Entry):
    """A study with one result and one section.

    ``name``: of its command, stage, result file and make target. ``title``: of its section.
    ``link``: words that lead to the section. ``load``: imports the modules that do the work.
    """

    def __init__(
        self,
        name: str,
        title: str,
        link: str,
        add_command: Callable[[typer.Typer], None],
        load: Callable[[], Parts],
    ):
        def contents() -> Contents:
            run, stored, draw = load()

            def section(page: "Page") -> "Html":
                return page.section(name, name, title, lambda found: page.parts(draw(found)), name)

            return Contents((Result(name, run, stored),), (Section(name, link, section),))

        super().__init__(add_command, contents)
