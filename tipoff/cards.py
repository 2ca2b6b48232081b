"""Summaries of an object for users: a line for each fact, and a card for notebooks.

Both are made from the same facts: text by its title.
"""

from collections.abc import Mapping

from markupsafe import Markup

# Colours of the page around it, light or dark.
_TABLE = "border-collapse:collapse;color:inherit;background:transparent"
_CELL = (
    "text-align:left;vertical-align:top;color:inherit;background:transparent;padding:2px 12px 2px 0"
)
_LINE = "border-bottom:1px solid;border-color:color-mix(in srgb,currentColor 25%,transparent)"


class Carded:
    """Base of classes with a ``summary`` and a card, both from their facts."""

    def _facts(self) -> dict[str, str]:
        """Text by its title, most important first."""
        raise NotImplementedError

    def summary(self) -> str:
        """The main facts as text, a line each.

        Returns:
            str: lines of a title and words with units.

        Example:
            >>> import tipoff
            >>> print(tipoff.load("tiny").summary().splitlines()[0])
            name       tiny
        """
        return text(self._facts())

    def _repr_html_(self) -> str:
        """The card that a notebook shows."""
        return card(type(self).__name__, self._facts())


def text(facts: Mapping[str, str]) -> str:
    """``facts`` as lines of text, with aligned columns."""
    width = max(map(len, facts), default=0)
    return "\n".join(f"{title:{max(width, 10)}} {words}" for title, words in facts.items())


def card(title: str, facts: Mapping[str, str]) -> str:
    """``facts`` as a small HTML table under its ``title``; all text is escaped."""
    rows = Markup("").join(
        Markup('<tr style="{}"><th style="{}">{}</th><td style="{}">{}</td></tr>').format(
            _LINE + ";background:transparent", _CELL, name, _CELL, words
        )
        for name, words in facts.items()
    )
    return str(
        Markup('<table style="{}"><caption style="{}"><b>{}</b></caption>{}</table>').format(
            _TABLE, _CELL, title, rows
        )
    )


def fixed(value: float, decimals: int, sign: str = "") -> str:
    """``value`` with so many ``decimals``, never minus zero; ``sign`` "+" also marks a positive one."""
    shown = round(value, decimals) + 0.0
    return f"{shown:{sign if shown else ''}.{decimals}f}"
