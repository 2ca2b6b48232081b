"""The same work in other codes: CalculiX, scikit-fem, Exudyn, MuJoCo."""

from tipoff.studies.question import Contents, Entry, Result, Section
from validation.peers import command


def _load() -> Contents:
    from validation.peers import page

    return Contents(
        (Result("peers", stored=page.stored),),
        (Section("peers", "Other codes", page.draw, "Compared with other codes"),),
    )


ENTRY = Entry((command.peers,), _load)
