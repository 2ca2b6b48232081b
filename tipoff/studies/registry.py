"""All studies. A study of the package is added here and nowhere else: its command, its result and its
section of the page follow."""

from tipoff.studies import (
    ablation,
    agreement,
    blind,
    calibration,
    convergence,
    cost,
    curves,
    ensemble,
    flight,
    limits,
    measured,
    mesh,
    nominal,
    runs,
    sensitivity,
    single,
    sweeps,
    view,
)
from tipoff.studies.commands.running import PROGRAMS
from tipoff.studies.question import Contents, Entry, Result, Section

# In the order of their commands; the report makes their results in this order.
COMPARISON: tuple[Entry, ...] = (
    nominal.ENTRY,
    mesh.ENTRY,
    runs.ENTRY,
    calibration.ENTRY,
    agreement.ENTRY,
    blind.ENTRY,
    curves.QUESTION,
    cost.QUESTION,
    ablation.QUESTION,
    convergence.QUESTION,
    view.ENTRY,
)
ON_DEMAND: tuple[Entry, ...] = (single.ENTRY, ensemble.ENTRY)
# Studies for the questions of an engineer.
QUESTIONS: tuple[Entry, ...] = (
    sensitivity.ENTRY,
    sweeps.ENTRY,
    limits.QUESTION,
    flight.QUESTION,
    measured.QUESTION,
)
ADDED: list[Entry] = []

# The first sections of the page in their order; those of all other studies follow.
_FIRST = (
    "mesh",
    "compliance",
    "thrust",
    "figure6",
    "contact-forces",
    "energy",
    "stress",
    "calibration",
    "agreement-section",
    "growth-section",
    "speedup",
    "rails",
    "cost",
    "convergence",
    "ablation",
)


def add(*entries: Entry, program: str) -> None:
    """Add studies from outside the package: this process makes their results and shows their sections.
    ``cli.add`` adds their commands, which ``program`` runs."""
    ADDED.extend(entry for entry in entries if entry not in ADDED)
    PROGRAMS.update({made.__name__: program for entry in entries for made in entry.commands})


def _loaded() -> list[Contents]:
    return [entry.load() for entry in (*COMPARISON, *ON_DEMAND, *QUESTIONS, *ADDED)]


def results() -> list[Result]:
    """The results of all studies."""
    return [result for contents in _loaded() for result in contents.results]


def sections() -> list[Section]:
    """The sections of all studies, in the order of the page."""
    found = {section.anchor: section for item in _loaded() for section in item.sections}
    return [found[anchor] for anchor in dict.fromkeys((*_FIRST, *found))]
