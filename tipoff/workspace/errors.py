"""Failures of studies, distinct from bad input and from errors of the program."""


class StudyError(RuntimeError):
    """A study cannot continue because runs that it needs failed; the message names them and why."""
