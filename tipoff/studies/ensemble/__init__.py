"""Many varied cases of the surrogate, and what they say."""

from tipoff.studies.ensemble import command
from tipoff.studies.question import Entry

ENTRY = Entry(command.add)
