"""Guides of a payload on its rail: a button, which is the pads of one foot, or a pad without a foot."""

from collections.abc import Sequence
from typing import NamedTuple

from tipoff.scenes.tables import PadTable


class Guide(NamedTuple):
    """One guide."""

    name: str  # "button 1", "pad 3"
    pads: tuple[int, ...]  # indices of its pads
    foot: tuple[float, float, float] | None  # m, from the nominal mass centre; None for a pad


def from_pads(pads: Sequence[PadTable]) -> list[Guide]:
    """The guides of ``pads``, in the order of their first pads."""
    found: dict[tuple, list[int]] = {}
    for index, pad in enumerate(pads):
        found.setdefault((index,) if pad.foot is None else pad.foot, []).append(index)
    guides, buttons = [], 0
    for members in found.values():
        foot = pads[members[0]].foot
        buttons += foot is not None
        name = f"pad {members[0] + 1}" if foot is None else f"button {buttons}"
        guides.append(Guide(name, tuple(members), foot))
    return guides


def numbers(pads: Sequence[PadTable]) -> list[int]:
    """Index of the guide of each of ``pads``."""
    found = {pad: number for number, guide in enumerate(from_pads(pads)) for pad in guide.pads}
    return [found[pad] for pad in range(len(pads))]
