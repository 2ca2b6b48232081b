"""Two measured launches of rockets from their rails beside the complete surrogate."""

from tipoff.studies.question import Entry
from validation.flights import command

ENTRY = Entry((command.flights,))
