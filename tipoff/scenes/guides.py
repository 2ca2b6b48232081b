"""Guides of a payload on its rail: a button or a lug, which is the pads of one foot, or a pad without a foot."""

from collections.abc import Sequence
from typing import NamedTuple

from tipoff.scenes.tables import PadTable


class Guide(NamedTuple):
    """One guide."""

    name: str  # "button 1", "lug 2", "pad 3"
    pads: tuple[int, ...]  # indices of its pads
    foot: tuple[float, float, float] | None  # m, from the nominal mass centre; None for a pad


def from_pads(pads: Sequence[PadTable]) -> list[Guide]:
    """The guides of ``pads``, in the order of their first pads."""
    found: dict[tuple, list[int]] = {}
    for index, pad in enumerate(pads):
        found.setdefault((index,) if pad.foot is None else pad.foot, []).append(index)
    guides, parts = [], 0
    for members in found.values():
        foot = pads[members[0]].foot
        parts += foot is not None
        kind = "lug" if foot and _encloses([pads[index] for index in members], foot) else "button"
        name = f"pad {members[0] + 1}" if foot is None else f"{kind} {parts}"
        guides.append(Guide(name, tuple(members), foot))
    return guides


def _encloses(pads: Sequence[PadTable], foot: tuple[float, float, float]) -> bool:
    """Whether faces along Y look inwards: around a rod, and not from inside of a slot."""
    inward = [pad.position[1] - foot[1] for pad in pads if pad.normals == ("-y",)]
    return bool(inward) and min(inward) > 0.0


def numbers(pads: Sequence[PadTable]) -> list[int]:
    """Index of the guide of each of ``pads``."""
    found = {pad: number for number, guide in enumerate(from_pads(pads)) for pad in guide.pads}
    return [found[pad] for pad in range(len(pads))]
