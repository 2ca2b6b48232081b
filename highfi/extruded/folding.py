"""Mirror symmetry of a section: neighbours of a column that share their stiffness.

Let neighbours at (+dy, dz) and (-dy, dz) have the same numbers except for the sign of those that
couple y with another direction, as on any even piece of a section. Then ``a u(+) +- a u(-) = a
(u(+) +- u(-))``: one product for both, and one addition, which is almost free on processors with
parallel units. Four neighbours mirrored in y and z need one product. A neighbour on a mirror plane
has no odd numbers. A column inside a regular section needs 36 products instead of 9 x 14.

The numbers of one neighbour are D xx yy yz zy zz, L the same and O xy xz yx zx, as in ``mesh``.
"""

from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

_SAME = 1e-12  # of the largest number; a smaller difference is rounding
_GRID = 1e-7  # m, offsets are rounded to it before a comparison

# (row, column) of each number; it changes sign under the mirror of a direction that is exactly one
# of them.
PLACES = (
    *((i, j) for _ in "DL" for i, j in ((0, 0), (1, 1), (1, 2), (2, 1), (2, 2))),
    (0, 1),
    (0, 2),
    (1, 0),
    (2, 0),
)


def odd(number: int, axis: int) -> bool:
    """Whether a number changes sign under the mirror of ``axis`` (1 y, 2 z)."""
    return (PLACES[number][0] == axis) != (PLACES[number][1] == axis)


class Kind(NamedTuple):
    """A kind of group of neighbours that are mirror images of each other."""

    # axes of the mirrors; order of the members: +, -; for both axes ++, -+, +-, --
    folded: tuple[int, ...]
    numbers: tuple[int, ...]  # the numbers that are not zero

    @property
    def members(self) -> int:
        """Neighbours in a group."""
        return 2 ** len(self.folded)


def _kind(folded: tuple[int, ...], even: tuple[int, ...]) -> Kind:
    """The kind whose numbers that are odd in ``even`` axes are zero."""
    return Kind(
        folded, tuple(n for n in range(len(PLACES)) if not any(odd(n, axis) for axis in even))
    )


# Of kinds with the same members, the one with fewer numbers comes first.
KINDS = (
    _kind((1, 2), ()),
    _kind((1,), (2,)),
    _kind((1,), ()),
    _kind((2,), (1,)),
    _kind((2,), ()),
    _kind((), (1, 2)),
    _kind((), (1,)),
    _kind((), (2,)),
    _kind((), ()),
)


# Number of groups of each kind in the most frequent columns: inside a section, on a side along y,
# on a side along z.
PATTERNS = ((1, 1, 0, 1, 0, 1, 0, 0, 0), (0, 0, 2, 0, 0, 0, 2, 0, 0), (0, 0, 0, 0, 2, 0, 0, 2, 0))


class Groups(NamedTuple):
    """Groups of s columns, column by column, in the order of KINDS within each column."""

    pattern: np.ndarray  # (s,) index in PATTERNS; the length of PATTERNS for any other pattern
    counts: np.ndarray  # (s, kinds) groups of each kind
    members: np.ndarray  # first nodes of the neighbours
    numbers: np.ndarray  # N/m
    first_member: np.ndarray  # (s,) place in ``members`` of the first one of each column
    first_number: np.ndarray  # (s,) place in ``numbers`` of the first one of each column


def fold(
    first: np.ndarray, neighbour: np.ndarray, offsets: np.ndarray, numbers: np.ndarray
) -> Groups:
    """Groups of the neighbours (q,) of each column, those of column i from ``first[i]`` on.

    ``offsets`` (q,2) m: place of the neighbour in the section minus that of the column; ``numbers``
    (q,14) N/m.
    """
    limit, places = (
        _SAME * np.abs(numbers).max(),
        np.round(offsets / _GRID).astype(np.int64).tolist(),
    )
    found = [
        _groups({tuple(places[q]): q for q in range(a, b)}, numbers, limit)
        for a, b in pairwise(first)
    ]
    counts = np.array([[len(groups) for groups in kinds] for kinds in found], dtype=np.int64)
    size = (
        np.array([kind.members for kind in KINDS]),
        np.array([len(kind.numbers) for kind in KINDS]),
    )
    first_member, first_number = (
        np.concatenate([[0], np.cumsum(counts @ each)[:-1]]).astype(np.int64) for each in size
    )
    flat = [group for kinds in found for groups in kinds for group in groups]
    pattern = [
        PATTERNS.index(own) if (own := tuple(each)) in PATTERNS else len(PATTERNS)
        for each in counts.tolist()
    ]
    return Groups(
        pattern=np.array(pattern),
        counts=counts,
        members=neighbour[np.concatenate([members for members, _ in flat])].astype(np.int64),
        numbers=np.concatenate([values for _, values in flat]),
        first_member=first_member,
        first_number=first_number,
    )


def _groups(at: dict, numbers: np.ndarray, limit: float) -> list[list]:
    """For each kind the groups (members, numbers) of one column; ``at``: its neighbours by
    offset."""
    left = dict(at)
    found: list[list] = [[] for _ in KINDS]
    for number, kind in enumerate(KINDS):
        for offset in at if left else ():
            places = [(y * offset[0], z * offset[1]) for y, z in _MIRRORS[number]]
            if len(set(places)) < len(places) or not left.keys() >= set(places):
                continue
            folded = numbers[[at[place] for place in places]] * _SIGNS[number]
            mean = folded.mean(axis=0)
            if np.abs(folded - mean).max() <= limit and (
                np.abs(mean[_ABSENT[number]]).max(initial=0.0) <= limit
            ):
                own = [left.pop(place) for place in places]
                found[number].append((own, mean[list(kind.numbers)]))
    return found


def _mirrors(kind: Kind) -> list[tuple[int, int]]:
    """Signs of (dy, dz) of the members."""
    return [
        (y, z) for z, y in product(*((1, -1) if axis in kind.folded else (1,) for axis in (2, 1)))
    ]


def _signs(signs: tuple[int, int]) -> list[int]:
    """Sign of each number at the member with these signs."""
    return [
        int(np.prod([sign for axis, sign in zip((1, 2), signs) if odd(n, axis)]))
        for n in range(len(PLACES))
    ]


_MIRRORS = [_mirrors(kind) for kind in KINDS]
_SIGNS = [np.array([_signs(signs) for signs in mirrors]) for mirrors in _MIRRORS]
# The numbers that are zero in each kind.
_ABSENT = [[n for n in range(len(PLACES)) if n not in kind.numbers] for kind in KINDS]
