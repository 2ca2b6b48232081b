"""Sink of a pad into its wall under the static load of a scene. A large sink shows a stiffness in
the wrong unit.

The load is the largest static load of one face: the peak of the thrust across the axis and the
weight, both on this face alone, plus the force of the couple over the distance L of the outermost
pads that balances the thrust's moment M about the mass centre::

    F = P sin t + m |g_yz| + M / L

    springs     p = (F / k)^(1 / e)          finite elements and compliant contact     p = F / (k_i A)

A is the area of the smallest face. Springs represent rail and contact together. Their limit
is the larger one of the clearance and 1 % of the shortest side of a pad, a strain at which any
metal yields. The interface stiffness represents only asperities and coating, and the rail bends
too, so its limit is a tenth of that."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust
from tipoff.scenes import launch, moments
from tipoff.scenes.effects import registry

_STRAIN = 0.01  # of a pad's shortest side
_LAYER = "pad_layer"
_THOUSAND = 1e3  # between N and kN, and between m and mm


class _Spring(NamedTuple):
    """A stiffness of ``[contact]``."""

    key: str
    value: float  # SI
    exponent: float  # of the sink in the law of the force
    lengths: float  # power of the length in the unit
    area: float  # m2, 1 if the unit contains no area
    share: float  # of the clearance: largest plausible sink
    share_in_words: str

    def sink(self, load: float, factor: float = 1.0) -> float:
        """Sink (m) under a load (N), at ``factor`` times the stiffness."""
        return (load / (factor * self.value * self.area)) ** (1.0 / self.exponent)


def load(scene) -> float:
    """Largest static load (N) of one pad face across the axis, see the module docstring."""
    peak = float(thrust.peak(ends.over_time(launch.of_scene(scene)), scene.time_limit))
    tilt = scene.thrust_offset.misalignment.axial if scene.thrust_offset is not None else 0.0
    force = registry.body_force(scene)
    weight = scene.payload.mass * float(np.hypot(force.y, force.z)) if force is not None else 0.0
    places = [pad.position[0] for pad in scene.pads]
    between = max(max(places) - min(places), max(pad.length for pad in scene.pads))
    return abs(peak * np.sin(tilt)) + weight + float(moments.transverse(scene, {}, peak)) / between


def warnings(scene) -> list[str]:
    """A message for each stiffness of ``[contact]`` with an implausible sink of a pad."""
    contact, force = scene.contact, load(scene)
    side = min(min(pad.length, pad.width) for pad in scene.pads)
    base, in_words = max(
        (contact.narrowest(), "the clearance"), (_STRAIN * side, "1 % of a pad's shortest side")
    )
    area = min(pad.length * pad.width for pad in scene.pads)
    springs = (
        _Spring(
            key="stiffness",
            value=contact.stiffness,
            exponent=contact.exponent,
            lengths=contact.exponent,
            area=1.0,
            share=1.0,
            share_in_words="",
        ),
        *_layers(contact, area),
    )
    found = []
    for spring in springs:
        plausible = spring.share * base
        if (sink := spring.sink(force)) > plausible:
            text = _given(scene, spring)
            meant = next(
                (
                    f"; {words} it would be {_length(spring.sink(force, factor))}"
                    for words, factor in _units_meant(text, spring)
                    if spring.sink(force, factor) <= plausible
                ),
                "",
            )
            found.append(
                f"contact.{spring.key}: under {text} a pad sinks {_length(sink)} at a static load "
                f"of {force:.3g} N, "
                f"plausible up to {_length(plausible)}, {spring.share_in_words}{in_words}{meant}"
            )
    return found


def _layers(contact, area: float) -> Iterator[_Spring]:
    """The interface, up to a tenth of the limit. If the pad has a soft layer, also both in series,
    up to the whole limit."""
    yield _Spring(
        key="interface_stiffness",
        value=contact.interface_stiffness,
        exponent=1.0,
        lengths=3.0,
        area=area,
        share=0.1,
        share_in_words="a tenth of ",
    )
    if contact.pad_layer is not None:
        yield _Spring(
            key=_LAYER,
            value=contact.series_stiffness(),
            exponent=1.0,
            lengths=3.0,
            area=area,
            share=1.0,
            share_in_words="",
        )


def _given(scene, spring: _Spring) -> str:
    """The stiffness as given in the scene, else in SI."""
    given = scene.given(f"contact.{spring.key}")
    return given if isinstance(given, str) else f"{spring.value:.4g} N/m**{spring.lengths:g}"


def _units_meant(text: str, spring: _Spring) -> Iterator[tuple[str, float]]:
    """Units that the user may have meant, in words, and their stiffness over that of the given
    unit; none for a layer, which is given by thickness and modulus."""
    if spring.key == _LAYER:
        return
    lengths = spring.lengths
    small, large = "mm" not in text, "N" in text and "kN" not in text
    if small:
        yield "in mm instead of m", _THOUSAND**lengths
    if large:
        yield "in kN instead of N", _THOUSAND
    if small and large:
        yield "in kN and mm instead of N and m", _THOUSAND ** (lengths + 1.0)


def _length(metres: float) -> str:
    return f"{1e3 * metres:.3g} mm"
