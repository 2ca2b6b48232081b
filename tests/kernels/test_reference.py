"""Records that kernels receive by their address: what a kernel reads is what Python holds."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import TypingError

from tipoff.kernels.jit import entry, kernel
from tipoff.kernels.reference import by_reference


class Point(NamedTuple):
    """A record that is passed as its parts."""

    x: float
    y: float


@by_reference
class Inner(NamedTuple):
    """A record within a record."""

    flag: bool
    values: np.ndarray
    count: int


@by_reference
class Outer(NamedTuple):
    """Members of all kinds."""

    inner: Inner
    absent: Inner | None
    point: Point
    pair: tuple
    scale: float
    words: np.ndarray


class Holder(NamedTuple):
    """A record of parts that holds one by reference."""

    outer: Outer
    number: int


def outer(absent=None, flag=True) -> Outer:
    """A record with its own arrays."""
    return Outer(
        inner=Inner(flag=flag, values=np.arange(4.0), count=3),
        absent=absent,
        point=Point(x=0.5, y=-2.0),
        pair=(7, 1.5),
        scale=10.0,
        words=np.array([2, 4], dtype=np.uint32),
    )


@kernel
def weighed(inner):
    return inner.values[inner.count] if inner.flag else -1.0


@kernel
def absence(inner):
    return 100.0 if inner is None else inner.values[0]


@entry
def read(record):
    return (
        weighed(record.inner),
        absence(record.absent),
        record.point.x + record.point.y,
        record.pair[0] * record.pair[1],
        record.scale,
        record.words[1],
    )


@entry
def read_within(holder):
    return weighed(holder.outer.inner) + holder.number


@entry
def doubled(record, other):
    for i in range(record.inner.values.size):
        record.inner.values[i] *= other.scale
    return record.inner.values.sum()


@entry
def made(values):
    return Inner(True, values, 1).values[1]


def test_members_of_all_kinds_are_read():
    assert read(outer()) == (3.0, 100.0, -1.5, 10.5, 10.0, 4)
    present = Inner(flag=False, values=np.full(2, 8.0), count=0)
    assert read(outer(present, flag=False)) == (-1.0, 8.0, -1.5, 10.5, 10.0, 4)


def test_a_record_of_parts_holds_one():
    assert read_within(Holder(outer(), 40)) == 43.0


def test_what_a_kernel_writes_to_an_array_python_sees():
    """Also where both arguments are the same record."""
    record = outer()
    assert doubled(record, record) == 60.0
    assert record.inner.values.tolist() == [0.0, 10.0, 20.0, 30.0]


def test_records_are_distinguished_by_their_members():
    """A kernel is compiled anew for arrays of another kind, and not for other values."""
    before = len(weighed_alone.signatures)
    assert weighed_alone(Inner(True, np.arange(4.0), 2)) == 2.0
    assert weighed_alone(Inner(True, np.arange(9.0) + 1.0, 8)) == 9.0
    assert len(weighed_alone.signatures) == before + 1
    assert weighed_alone(Inner(True, np.arange(4), 2)) == 2
    assert len(weighed_alone.signatures) == before + 2


@entry
def weighed_alone(inner):
    return inner.values[inner.count]


def test_a_member_that_no_kernel_takes_is_refused():
    with pytest.raises(TypingError):
        read(outer()._replace(scale=object()))


def test_what_a_kernel_makes_itself_is_a_record_of_parts():
    assert made(np.arange(3.0)) == 1.0
