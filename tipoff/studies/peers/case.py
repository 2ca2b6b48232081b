"""A comparison with another code: one case, solved here and by the peer from the same inputs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


class PeerMissing(RuntimeError):
    """The peer is not installed here; the message says how to install it."""


@dataclass(frozen=True)
class Case:
    """One case.

    ``name``: its file, ``title``: in the page. ``inputs``: plain values, kept with the result.
    ``matched`` and ``unmatched``: what both sides share, and what the peer cannot express.
    ``settings``: names of meshes or steps. ``units``: the unit of each quantity. ``ours`` and
    ``theirs`` map a setting to the values of these quantities, in that unit. ``within``: largest
    relative difference of a quantity at the settings it names, relative to its largest value over
    the settings; ``slow``: settings that take more than a few seconds here.
    """

    name: str
    title: str
    inputs: Callable[[], Mapping[str, Any]]
    matched: str
    unmatched: str
    settings: tuple[str, ...]
    units: Mapping[str, str]
    ours: Callable[[str], Mapping[str, float]]
    theirs: Callable[[str], Mapping[str, float]]
    within: Mapping[str, float]
    slow: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class Peer:
    """Another code. ``version`` raises PeerMissing where it is not installed."""

    name: str
    what: str  # kind of code, in words
    version: Callable[[], str]
    cases: Callable[[], tuple[Case, ...]]
