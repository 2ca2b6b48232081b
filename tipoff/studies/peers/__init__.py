"""The same work in other codes: CalculiX, scikit-fem, Exudyn, MuJoCo."""

from tipoff.studies.peers import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.peers import page

    return Contents(
        (Result("peers", stored=page.stored),),
        (Section("peers", "Other codes", page.draw, "Compared with other codes"),),
    )


ENTRY = Entry((command.peers,), _load)
