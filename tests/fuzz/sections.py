"""Mutants of sections in files: drawings in DXF, and solids in STEP."""

import random
from pathlib import Path

from tests.formats.sections.step_text import prism
from tests.formats.sections.test_dxf import arc, drawing, line, polyline
from tests.fuzz import mutants
from tests.scenes.support import small
from tests.scenes.test_profile_rail import RAIL
from tipoff import scenes
from tipoff.highfi.rail import profile_rail

_SQUARE = ((0, 0), (20, 0), (20, 20), (0, 20))
TEXTS = {
    "dxf": (
        drawing(polyline(*_SQUARE), polyline((5, 5), (9, 5, 1), (9, 9), (5, 9, -0.4))),
        drawing(
            line(0, -9, 20, -9), arc(20, 0, 9, 270, 90), line(0, 9, 20, 9), arc(0, 0, 9, 90, 270)
        ),
    ),
    "step": (prism(_SQUARE, 200.0), prism(_SQUARE, 9.0, "in"), prism(_SQUARE, 200.0, "none")),
}


def _section(rng: random.Random, folder: Path) -> None:
    suffix = rng.choice(("dxf", "step", "step"))
    file = folder / f"rail.{suffix}"
    text = rng.choice(TEXTS[suffix])
    if rng.random() < 0.7:
        file.write_bytes(mutants.of_text(rng, text).encode("utf-8", "surrogatepass"))
    else:
        file.write_bytes(mutants.of_bytes(rng, text.encode()))
    rail = RAIL | {"section": str(file), "mounted": [["10 mm", "0 mm"]]}
    if rng.random() < 0.2:
        rail["unit"] = rng.choice(("mm", "in", "ft", "parsec"))
    scene = scenes.parse(small(rail=rail))
    assert scene.hash and scene.warnings is not None
    profile_rail.profile(scene, scene.rail)


KINDS = {"section": _section}
