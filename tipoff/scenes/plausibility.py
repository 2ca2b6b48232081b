"""Warnings about values that are valid but probably wrong, for example in their unit. Each names
its fields; no value is changed."""

import itertools
import math

import numpy as np

from tipoff.formats.outline import SAME
from tipoff.mechanics.laws.thermal import fields
from tipoff.scenes import launch, plausible_ranges, sinking, thrust_plausibility
from tipoff.scenes.profile_rail import ProfileTable
from tipoff.scenes.rail_base import HeldBySpans
from tipoff.scenes.rounding import below

_WAVE_SPEED = (100.0, 10_000.0)
_DENSITY = (10.0, 20_000.0)
# N/m3: from a millimetre of rubber to ground surfaces under the highest pressure of a bolt
_JOINT = (1e9, 1e16)
_EXPANSION = 1e-4  # 1/K: polymers; metals have at most a third of it
_FREE_STRAIN = 5e-3  # 200 K in aluminium, whose constants change by then

# Of the inertia of a box of uniform density. Three times, the largest value: all mass at the
# corners. A third: all mass within 0.58 of each side.
_LEAST, _MOST = 1.0 / 3.0, 3.0
# ratio of the compliance of a free end of a rail to that of its widest gap between two mounts
_SOFTER = 8.0


def warnings(scene) -> list[str]:
    """Messages with the names of the fields and the plausible range."""
    found = []
    material = scene.rail.material
    speed = math.sqrt(material.youngs_modulus / material.density)
    if not _WAVE_SPEED[0] <= speed <= _WAVE_SPEED[1]:
        found.append(
            f"rail.material.youngs_modulus, rail.material.density: wave speed {speed:.4g} m/s, "
            f"plausible {_WAVE_SPEED[0]:g} to {_WAVE_SPEED[1]:g} m/s"
        )
    if scene.payload.size is not None:
        density = scene.payload.mass / math.prod(scene.payload.size)
        if not _DENSITY[0] <= density <= _DENSITY[1]:
            found.append(
                f"payload.mass, payload.size: mean density {density:.4g} kg/m3, "
                f"plausible {_DENSITY[0]:g} to {_DENSITY[1]:g} kg/m3"
            )
    found += plausible_ranges.warnings(scene) + _of_inertia(scene) + _of_mounts(scene.rail)
    found += _of_length(scene.rail)
    found += _of_joints(scene.rail.mount_stiffness) + thrust_plausibility.warnings(scene)
    if scene.contact is not None:
        found += sinking.warnings(scene) + _of_interface(scene.contact) + _of_pads(scene)
    if scene.friction is not None and below(scene.friction.static, scene.friction.dynamic):
        found.append(
            f"friction.static, friction.dynamic: {scene.friction.static:.4g} and "
            f"{scene.friction.dynamic:.4g}, plausible a static coefficient that is not the smaller one"
        )
    if scene.thermal is not None:
        found += _of_temperature(scene)
    if scene.initial is not None and scene.platform is None:
        found += _of_fixed_platform(scene.initial.record())
    return found


def _of_inertia(scene) -> list[str]:
    """Moments of inertia that are impossible or implausible for a body of this mass in a box with
    sides a, b and c.

    A body of uniform density has I_xx = m (b^2 + c^2) / 12, and no body has more than three times
    this value: the mean of (y - y_c)^2 over mass between two planes b apart is at most b^2 / 4
    (Popoviciu). Without ``payload.size`` the box is that of the pads, and may be longer along X.
    (Popoviciu). Without ``payload.size`` the box is that of the pads, and may be longer along X.
    """
    payload, wrong = scene.payload, []
    pads = [2.0 * max(abs(pad.position[axis]) for pad in scene.pads) for axis in range(3)]
    sides = payload.size or (pads[0] + max(pad.length for pad in scene.pads), *pads[1:])
    for axis, name in enumerate("xyz"):
        even = (
            payload.mass * sum(side**2 for other, side in enumerate(sides) if other != axis) / 12.0
        )
        most = _MOST * even if payload.size or axis == 0 else math.inf
        moment = getattr(payload.inertia, 2 * name)
        if not _LEAST * even <= moment <= most:
            wrong.append(
                (
                    f"payload.inertia.{2 * name}",
                    f"{moment:.4g} kg m2 (plausible {_LEAST * even:.3g} "
                    f"{f'to {most:.3g} kg m2' if math.isfinite(most) else 'or more'})",
                )
            )
    if not wrong:
        return []
    keys = ", ".join(
        ["payload.mass", *(key for key, _ in wrong), "payload.size" if payload.size else "pads"]
    )
    return [
        f"{keys}: {payload.mass:.4g} kg in {' x '.join(f'{side:.3g}' for side in sides)} m with "
        f"{', '.join(words for _, words in wrong)}"
    ]


def _of_mounts(rail) -> list[str]:
    """A free end of a rail of one section that is far more compliant than the rail between two mounts.

    The deflection is F a^3 / (3 E I) at the tip of a cantilever of length a, and F g^3 / (192 E I)
    in the middle of a span g clamped at both ends: a ratio of 64 (a / g)^3. Without such a span all
    mounts together count as one.
    """
    if not isinstance(rail, HeldBySpans) or not rail.mounts:
        return []
    mounts = sorted(rail.mounts, key=lambda span: span.start)
    gaps = [after.start - before.end for before, after in itertools.pairwise(mounts)]
    gap = max(gaps, default=0.0) or mounts[-1].end - mounts[0].start
    allowed, found = gap * (_SOFTER / 64.0) ** (1.0 / 3.0), []
    for end, free in (("rear", mounts[0].start), ("open", rail.end - rail.start - mounts[-1].end)):
        if free > allowed:
            found.append(
                f"rail.mounts, rail.start, rail.end: {1e3 * free:.4g} mm at the {end} end are not "
                f"held, plausible up to "
                f"{1e3 * allowed:.4g} mm; their compliance is {64.0 * (free / gap) ** 3:.3g} times "
                f"that between mounts"
            )
    return found


def _of_length(rail) -> list[str]:
    """A solid of another length than the rail, which has its section only."""
    drawn = rail.solid_length() if isinstance(rail, ProfileTable) else None
    if drawn is None or abs(drawn - (rail.end - rail.start)) < SAME:
        return []
    return [
        f"rail.section, rail.start, rail.end: the solid is {drawn:.6g} m long, the rail "
        f"{rail.end - rail.start:.6g} m from start to end, which counts"
    ]


def _of_pads(scene) -> list[str]:
    """Pads that begin beyond an end of the rail. Beyond the open end they never touch it."""
    for end, way in ((scene.rail.end, 1.0), (scene.rail.start, -1.0)):
        if outside := launch.pads_beyond(scene, end, way):
            listed = ", ".join(map(str, outside))
            return [
                f"pads, rail.start, rail.end: at ignition pads {listed} are outside the rail, "
                f"{scene.rail.start:.4g} to {scene.rail.end:.4g} m along X"
            ]
    return []


def _of_fixed_platform(initial) -> list[str]:
    """Motion of a platform that the scene has not."""
    return [
        f"initial.{name}: no effect on fixed rails; [platform] describes a platform that moves"
        for name in ("platform_velocity", "platform_rate")
        if any(getattr(initial, name))
    ]


def _of_joints(table) -> list[str]:
    """Joints under the mounts that seem to have a wrong unit, or are stiffer in shear than along
    their normal. No contact of asperities is stiffer in shear
    (``scenes.effects.mount_stiffness``)."""
    if table is None:
        return []
    keys, joint = "rail.mount_stiffness.normal, rail.mount_stiffness.shear", table.record()
    given = f"{keys}: {joint.normal:.4g} and {joint.shear:.4g} N/m3, plausible"
    if not (_JOINT[0] <= min(joint) and max(joint) <= _JOINT[1]):
        return [f"{given} {_JOINT[0]:g} to {_JOINT[1]:g} N/m3"]
    return [f"{given} a shear stiffness below the normal one"] if joint.shear > joint.normal else []


def _of_interface(contact) -> list[str]:
    """A stiffness above that of any contact of asperities. The number of steps of the reference
    grows with its square root. ``sinking`` warns of soft ones."""
    if (found := contact.interface_stiffness) <= _JOINT[1]:
        return []
    return [
        f"contact.interface_stiffness: {found:.4g} N/m3, plausible up to {_JOINT[1]:g} N/m3; the "
        f"steps of the reference shrink with its square root"
    ]


def _of_temperature(scene) -> list[str]:
    found, expansion = [], scene.rail.material.expansion
    if not 0.0 <= expansion <= _EXPANSION:
        found.append(
            f"rail.material.expansion: {expansion:.4g} 1/K, plausible 0 to {_EXPANSION:g} 1/K"
        )
    thermal = scene.thermal.record(scene.rail)
    ends = np.array(
        [
            (x, y, z)
            for x in (scene.rail.start, scene.rail.end)
            for y, z in {pad.position[1:] for pad in scene.pads}
        ]
    )
    largest = float(abs(fields(ends, thermal.middle) @ thermal.amounts[:-1]).max())
    if largest > _FREE_STRAIN:
        found.append(
            f"thermal: free thermal expansion of the rails of {100.0 * largest:.3g} %, plausible "
            f"up to {100.0 * _FREE_STRAIN:g} %"
        )
    return found
