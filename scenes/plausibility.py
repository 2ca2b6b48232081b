"""Values that pass validation and yet are probably a slip of units: warned about by field name, never changed."""

import math

from scenes.effects.thermal import fields

_WAVE_SPEED = (100.0, 10_000.0)
_DENSITY = (10.0, 20_000.0)
_EXPANSION = 1e-4  # 1/K: polymers; metals expand by a third of it at most
_FREE_STRAIN = 5e-3  # 200 K in aluminium, whose constants have changed by then


def warnings(scene) -> list[str]:
    """Messages that name the fields and the plausible range."""
    found = []
    material = scene.rail.material
    speed = math.sqrt(material.youngs_modulus / material.density)
    if not _WAVE_SPEED[0] <= speed <= _WAVE_SPEED[1]:
        found.append(f"rail.material.youngs_modulus, rail.material.density: wave speed {speed:.4g} m/s, "
                     f"plausible {_WAVE_SPEED[0]:g} to {_WAVE_SPEED[1]:g} m/s")
    if scene.payload.size is not None:
        density = scene.payload.mass / math.prod(scene.payload.size)
        if not _DENSITY[0] <= density <= _DENSITY[1]:
            found.append(f"payload.mass, payload.size: mean density {density:.4g} kg/m3, "
                         f"plausible {_DENSITY[0]:g} to {_DENSITY[1]:g} kg/m3")
    if scene.thermal is not None:
        found += _of_temperature(scene)
    return found


def _of_temperature(scene) -> list[str]:
    found, expansion = [], scene.rail.material.expansion
    if not 0.0 <= expansion <= _EXPANSION:
        found.append(f"rail.material.expansion: {expansion:.4g} 1/K, plausible 0 to {_EXPANSION:g} 1/K")
    thermal = scene.thermal.record(scene.rail)
    ends = [(x, y, z) for x in (scene.rail.start, scene.rail.end) for y, z in {pad.position[1:] for pad in scene.pads}]
    largest = float(abs(fields(ends, thermal.middle) @ thermal.amounts[:-1]).max())
    if largest > _FREE_STRAIN:
        found.append(f"thermal: rails that would expand by {100.0 * largest:.3g} % if they could, plausible up to "
                     f"{100.0 * _FREE_STRAIN:g} %")
    return found
