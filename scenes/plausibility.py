"""Values that pass validation and yet are probably a slip of units: warned about by field name, never changed."""

import math

_WAVE_SPEED = (100.0, 10_000.0)
_DENSITY = (10.0, 20_000.0)


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
    return found
