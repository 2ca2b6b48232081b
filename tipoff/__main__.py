"""``python -m tipoff``: the command ``tipoff``."""

from tipoff.studies.cli import app

app()
