"""Options of ``tipoff compare``."""

from dataclasses import dataclass

from tipoff.studies.commands.options import Neighbours


@dataclass(frozen=True)
class Options:
    """``neighbours`` of each condition that is judged as a distribution; None: those of the settings."""

    neighbours: Neighbours = None
