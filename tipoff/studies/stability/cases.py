"""Hard cases, each with a control: a simpler method that must fail, else the case proves nothing.

A case is a function without arguments that returns a ``Verdict``.
"""

from collections.abc import Callable

from tipoff.studies.stability import contacts, elastic, guides, thrusts
from tipoff.studies.stability.verdict import Verdict


def cases() -> dict[str, Callable[[], Verdict]]:
    """Every case by name."""
    return {**contacts.CASES, **guides.CASES, **thrusts.CASES, **elastic.CASES}
