"""The record of a study: its command, its results, its sections of the page."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part
    from tipoff.studies.report.page import Page
    from tipoff.workspace.stage import Made, Stage
    from tipoff.workspace.study import Study


class Result(NamedTuple):
    """A result of a study, from one result file or several, under its ``name`` on the page.

    ``run`` makes it. ``stored`` finds it if it was made from the present scene, code and settings.
    The report makes each result without ``stored``. It shows a result with ``stored`` if there is
    one. ``tipoff report --every`` also makes missing ones that have ``run``; if the report has limits of
    rates, ``within`` makes those that depend on limits, in the form of ``exceedance.limits``.
    """

    name: str
    run: "Callable[[Study], Made] | None" = None
    stored: "Callable[[Study], Any] | None" = None
    within: "Callable[[Study, tuple[str, ...]], Made] | None" = None


class Section(NamedTuple):
    """A section of the page.

    ``anchor``: its id in HTML. ``link``: the text of the link to it. ``draw``: makes its parts,
    empty where there is nothing to show. ``title``: its heading.
    """

    anchor: str
    link: str
    draw: Callable[["Page"], "Sequence[Part]"]
    title: str

    @classmethod
    def of_stage(
        cls,
        stage: "Stage",
        draw: "Callable[[Any], Sequence[Part]]",
        anchor: str,
        link: str,
        title: str,
        command: str = "",
    ) -> "Section":
        """The section that ``draw`` makes of the result of a ``stage``; without it, the ``command``
        that makes it, by default the ``anchor``."""
        return cls(anchor, link, lambda page: page.shown(stage, draw, command or anchor), title)


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


class Question(Entry):
    """A study with one result and one section. The name of its ``package`` is also the name of its
    command, section and make target.

    ``text``: the help of the command. ``title``: of its section. ``link``: the text of the link to
    the section. ``options``: the dataclass of its options; None without any. If options of the
    command belong to the study, the method ``asked`` of the dataclass returns the study of a
    request and the options of the stage. ``always``: whether each report makes the result. ``own``:
    a command in place of the one made from ``options``.

    The package has a module ``stage`` with ``run``, ``STAGE``, and ``stored`` if it replaces that
    of ``STAGE``. It may have a module ``page`` with ``draw``, which makes of a result the parts that
    the page and the terminal show. Without it they show the tables of the result. ``without``: the
    common options that the command does not have.
    """

    def __init__(
        self,
        package: str,
        text: str | None,
        title: str,
        link: str,
        options: type | None = None,
        always: bool = False,
        own: Callable[..., None] | None = None,
        without: Collection[str] = (),
    ):
        name = package.rpartition(".")[2]

        def modules() -> tuple[Any, Any]:
            stage = import_module(f"{package}.stage")
            if find_spec(f"{package}.page"):
                return stage, import_module(f"{package}.page")
            from tipoff.studies.render.document import tables_of

            return stage, SimpleNamespace(draw=tables_of)

        def answer(request: Request, options: Any) -> Output:
            stage, page = modules()
            if not stage.STAGE.of_scene:
                request.require_the_scene_as_it_is()
            if hasattr(options, "asked"):
                study, options = options.asked(request)
            else:
                study = request.study()
            found = stage.run(study, *([] if options is None else [options]))
            return Output.of(found, page.draw, request.out)

        def contents() -> Contents:
            stage, page = modules()

            def within(study: "Study", limits: tuple[str, ...]) -> "Made":
                return stage.run(study, options(limits=limits) if options else None)

            stored = None if always else getattr(stage, "stored", stage.STAGE.stored)
            limited = "limits" in getattr(options, "__dataclass_fields__", ())
            return Contents(
                (Result(stage.STAGE.name, stage.run, stored, within if limited else None),),
                (Section.of_stage(stage.STAGE, page.draw, name, link, title),),
            )

        super().__init__((own or command(name, text or "", options, answer, without),), contents)
