"""Single runs of one or more conditions, in a model that the user names or that the cost study chooses."""

from tipoff.studies.question import Entry
from tipoff.studies.single import command

ENTRY = Entry((command.run,))
