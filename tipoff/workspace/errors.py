"""Failures of studies, distinct from bad input and from errors of the program."""

from tipoff.faults import SceneError

FAILED = ("diverged", "refused")  # statuses of a run that cannot be used


class NotAsked(SceneError):
    """A result for which the scene states no inputs; a page of many results goes on without it."""


class StudyError(RuntimeError):
    """A study cannot continue because runs that it needs failed; the message names them and why."""
