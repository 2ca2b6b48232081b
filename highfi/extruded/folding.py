"""Mirror symmetry of a section: neighbours of a column that share their stiffness.

Let neighbours at (+dy, dz) and (-dy, dz) have the same numbers except for the sign of those that
couple y with another direction, as on any even piece of a section. Then ``a u(+) +- a u(-) = a
(u(+) +- u(-))``: one product for both, and one addition, which is almost free on processors with
parallel units. Four neighbours mirrored in y and z need one product. A neighbour on a mirror plane
has no odd numbers. A column inside a regular section needs 36 products instead of 9 x 14.

The numbers of one neighbour are those of the blocks of its ``Layout``, as in ``mesh``: xx yy yz zy zz
of the blocks that are even under the mirror x -> -x, then xy xz yx zx of O.
"""

from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

_SAME = 1e-12  # of the largest number; a smaller difference is rounding
_GRID = 1e-7  # m, offsets are rounded to it before a comparison

# (row, column) of the numbers of a block that is even, and of one that is odd, under x -> -x
EVEN_PLACES = ((0, 0), (1, 1), (1, 2), (2, 1), (2, 2))
ODD_PLACES = ((0, 1), (0, 2), (1, 0), (2, 0))


class Place(NamedTuple):
    """Place of a number in the blocks of one neighbour."""

    block: int
    row: int
    column: int

    def odd(self, axis: int) -> bool:
        """Whether the number changes sign under the mirror of ``axis`` (1 y, 2 z): if the axis is
        exactly one of row and column."""
        return (self.row == axis) != (self.column == axis)


class Kind(NamedTuple):
    """A kind of group of neighbours that are mirror images of each other."""

    # axes of the mirrors; order of the members: +, -; for both axes ++, -+, +-, --
    folded: tuple[int, ...]
    even: tuple[int, ...]  # axes in which odd numbers are zero

    @property
    def members(self) -> int:
        """Neighbours in a group."""
        return 2 ** len(self.folded)


# Of kinds with the same members, the one with fewer numbers comes first.
KINDS = (
    Kind((1, 2), ()),
    Kind((1,), (2,)),
    Kind((1,), ()),
    Kind((2,), (1,)),
    Kind((2,), ()),
    Kind((), (1, 2)),
    Kind((), (1,)),
    Kind((), (2,)),
    Kind((), ()),
)


class Layout(NamedTuple):
    """Numbers of one neighbour."""

    blocks: int  # of 3x3 numbers; the last one is odd under x -> -x
    places: tuple[Place, ...]  # of each number
    used: tuple[tuple[int, ...], ...]  # the numbers that are not zero, for each of KINDS


def _layout(even: int) -> Layout:
    """The layout of ``even`` even blocks and an odd one."""
    places = [Place(block, *place) for block in range(even) for place in EVEN_PLACES]
    places += [Place(even, *place) for place in ODD_PLACES]
    used = [
        tuple(n for n, place in enumerate(places) if not any(map(place.odd, kind.even)))
        for kind in KINDS
    ]
    return Layout(even + 1, tuple(places), tuple(used))


EQUAL, UNEQUAL = _layout(2), _layout(3)  # of equal layers, and of layers of any lengths

# Number of groups of each kind in columns that have code of their own; None for any number. Most columns are
# inside a section, on a side along y, on a side along z, or have no neighbours that are mirror images.
_PATTERNS: tuple[tuple[int | None, ...], ...] = (
    (1, 1, 0, 1, 0, 1, 0, 0, 0),
    (0, 0, 2, 0, 0, 0, 2, 0, 0),
    (0, 0, 0, 0, 2, 0, 0, 2, 0),
    (0, 0, 0, 0, 0, 0, 0, 0, None),
    (None,) * len(KINDS),
)
# A column has the first one that fits it.
VARIANTS = tuple((layout, pattern) for layout in (EQUAL, UNEQUAL) for pattern in _PATTERNS)


class Groups(NamedTuple):
    """Groups of s columns, column by column, in the order of KINDS within each column."""

    variant: np.ndarray  # (s,) index in VARIANTS
    counts: np.ndarray  # (s, kinds) groups of each kind
    members: np.ndarray  # first nodes of the neighbours
    numbers: np.ndarray  # N/m
    first_member: np.ndarray  # (s,) place in ``members`` of the first one of each column
    first_number: np.ndarray  # (s,) place in ``numbers`` of the first one of each column


def fold(
    layout: Layout,
    first: np.ndarray,
    neighbour: np.ndarray,
    offsets: np.ndarray,
    numbers: np.ndarray,
) -> Groups:
    """Groups of the neighbours (q,) of each column, those of column i from ``first[i]`` on.

    ``offsets`` (q,2) m: place of the neighbour in the section minus that of the column; ``numbers``
    (q,k) of the ``layout``.
    """
    limit, places = (
        _SAME * np.abs(numbers).max(),
        np.round(offsets / _GRID).astype(np.int64).tolist(),
    )
    rules = _rules(layout)
    found = [
        _groups(rules, {tuple(places[q]): q for q in range(a, b)}, numbers, limit)
        for a, b in pairwise(first)
    ]
    counts = np.array([[len(groups) for groups in kinds] for kinds in found], dtype=np.int64)
    size = (
        np.array([kind.members for kind in KINDS]),
        np.array([len(used) for used in layout.used]),
    )
    first_member, first_number = (
        np.concatenate([[0], np.cumsum(counts @ each)[:-1]]).astype(np.int64) for each in size
    )
    flat = [group for kinds in found for groups in kinds for group in groups]
    return Groups(
        variant=np.array([_variant(layout, each) for each in counts.tolist()]),
        counts=counts,
        members=neighbour[np.concatenate([members for members, _ in flat])].astype(np.int64),
        numbers=np.concatenate([values for _, values in flat]),
        first_member=first_member,
        first_number=first_number,
    )


def _variant(layout: Layout, counts: list[int]) -> int:
    """Index of the first of VARIANTS that fits a column with these ``counts`` of groups."""
    return next(
        k
        for k, (own, pattern) in enumerate(VARIANTS)
        if own == layout and all(given in (None, count) for given, count in zip(pattern, counts))
    )


class _Rule(NamedTuple):
    """How the numbers of the members of a kind of group become those of the group."""

    mirrors: list[tuple[int, int]]  # signs of (dy, dz) of the members
    signs: np.ndarray  # (members, k) of each number
    used: list[int]
    absent: list[int]  # numbers that must be zero


def _rules(layout: Layout) -> list[_Rule]:
    """The rules of all KINDS."""
    rules = []
    for kind, used in zip(KINDS, layout.used):
        mirrors = _mirrors(kind)
        signs = np.array([_signs(layout, each) for each in mirrors])
        absent = sorted(set(range(len(layout.places))) - set(used))
        rules.append(_Rule(mirrors, signs, list(used), absent))
    return rules


def _groups(rules: list[_Rule], at: dict, numbers: np.ndarray, limit: float) -> list[list]:
    """For each kind the groups (members, numbers) of one column; ``at``: its neighbours by
    offset."""
    left = dict(at)
    found: list[list] = [[] for _ in rules]
    for rule, groups in zip(rules, found):
        for offset in at if left else ():
            places = [(y * offset[0], z * offset[1]) for y, z in rule.mirrors]
            if len(set(places)) < len(places) or not left.keys() >= set(places):
                continue
            folded = numbers[[at[place] for place in places]] * rule.signs
            mean = folded.mean(axis=0)
            if np.abs(folded - mean).max() <= limit and (
                np.abs(mean[rule.absent]).max(initial=0.0) <= limit
            ):
                groups.append(([left.pop(place) for place in places], mean[rule.used]))
    return found


def _mirrors(kind: Kind) -> list[tuple[int, int]]:
    """Signs of (dy, dz) of the members."""
    return [
        (y, z) for z, y in product(*((1, -1) if axis in kind.folded else (1,) for axis in (2, 1)))
    ]


def _signs(layout: Layout, signs: tuple[int, int]) -> list[int]:
    """Sign of each number at the member with these signs."""
    return [
        int(np.prod([sign for axis, sign in zip((1, 2), signs) if place.odd(axis)]))
        for place in layout.places
    ]
