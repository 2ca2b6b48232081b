"""Counts in the output of commands agree with their noun."""

import pytest

from tipoff.workspace.words import counted


@pytest.mark.parametrize(
    ("number", "words"), [(0, "0 draws"), (1, "1 draw"), (2, "2 draws"), (12345, "12,345 draws")]
)
def test_a_noun_has_an_s_unless_there_is_one(number, words):
    assert counted(number, "draw") == words


def test_an_irregular_plural_is_given():
    assert counted(1, "search", "searches") == "1 search"
    assert counted(3, "search", "searches") == "3 searches"
