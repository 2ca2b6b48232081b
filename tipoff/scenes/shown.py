"""What a scene says of itself: the facts of its summary and of its card."""

from typing import TYPE_CHECKING

from tipoff.scenes.effects import thrust_law

if TYPE_CHECKING:
    from tipoff.scenes.scene import Scene

_MOST_NAMES = 12  # of conditions in one line


def facts(scene: "Scene") -> dict[str, str]:
    """Words with units by their title; implausible values are among them."""
    rail, contact = scene.rail, scene.contact
    found = {"name": scene.name}
    if scene.description:
        found["about"] = scene.description
    size = "" if scene.payload.size is None else f", {_mm(*scene.payload.size)}"
    found |= {
        "payload": f"{scene.payload.mass:g} kg{size}",
        "pads": f"{len(scene.pads)}",
        "rail": f"{_mm(rail.end - rail.start)} long, ends at X = {_mm(rail.end)}",
        "thrust": _thrust(scene),
        "contact": "absent" if contact is None else f"clearance {_gaps(contact)}",
        "friction": "absent" if scene.friction is None else f"dynamic {scene.friction.dynamic:g}",
        "platform": "rails are fixed"
        if scene.platform is None
        else f"free, {scene.platform.mass:g} kg",
        "duration": f"{1e3 * scene.duration:g} ms",
        "conditions": _names(list(scene.conditions)),
    }
    if absent := scene.absent_effects():
        found["absent"] = ", ".join(absent)
    if scene.warnings:
        found["implausible"] = "; ".join(scene.warnings)
    return found


def _thrust(scene: "Scene") -> str:
    record = scene.thrust.record()
    peak, whole = (law(record, scene.duration) for law in (thrust_law.peak, thrust_law.impulse))
    return f"{scene.thrust.kind}, peak {peak:.4g} N, impulse {whole:.4g} N*s within the duration"


def _gaps(contact) -> str:
    _, y, z = contact.gaps()
    return _mm(y) if y == z else f"{_mm(y)} along y, {_mm(z)} along z"


def _names(names: list[str]) -> str:
    if len(names) <= _MOST_NAMES:
        return ", ".join(names) or "none"
    return f"{', '.join(names[:_MOST_NAMES])} and {len(names) - _MOST_NAMES} more"


def _mm(*lengths: float) -> str:
    """Lengths (m) in mm."""
    return " x ".join(f"{1e3 * length:g}" for length in lengths) + " mm"
