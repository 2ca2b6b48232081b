"""Many varied cases of the surrogate, and their statistics."""

from tipoff.studies.ensemble import command
from tipoff.studies.question import Entry

ENTRY = Entry((command.ensemble,))
