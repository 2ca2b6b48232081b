"""Pictures of a run: VTK files of its frames for ParaView, and images where pyvista is installed."""

from tipoff.studies.question import Contents, Entry, Result
from tipoff.studies.view import command


def _load() -> Contents:
    from tipoff.studies.view import stage

    return Contents(
        (Result("view", stored=stage.stored),),
    )


ENTRY = Entry((command.view,), _load)
