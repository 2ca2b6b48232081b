"""``[rail]`` of a mesh, and of a section that the user draws."""

import copy

from tests.scenes.refusals import Written, case
from tests.scenes.section_shapes import T_SLOT
from tests.scenes.support import SMALL, small
from tipoff.scenes import parse

ENDS = {"start": "-0.1 m", "end": "0.1 m", "material": SMALL["rail"]["material"]}
SLOTTED = {key: value if key == "shape" else f"{value} m" for key, value in T_SLOT.items()}
SECTION = ENDS | {
    "mounts": [{"start": "0 mm", "end": "20 mm"}],
    "mounted": [["15 mm", "-20 mm"]],
    "section": SLOTTED,
}


def made(change: dict):
    return parse(small(rail=change))


def section(keys: str, *words: str, **changed):
    return case(copy.deepcopy(SECTION) | changed, keys, *words)


BESIDE = {"geometry": "rail.step", "mounts": [], "mount_width": "4 mm", "wall": "1 mm"}
READ = "a readable file ("
CASES = [
    case(
        ENDS | {"mesh": Written("a mesh"), "end": "-0.2 m"} | BESIDE,
        "rail.geometry rail.mounts rail.mount_width rail.wall rail.end",
        "rail.geometry: no such key with mesh",
        "an end beyond start, by 1e-06 m or more",
    ),
    case(ENDS | {"mesh": "/none.msh"}, "rail.mesh", READ + "No such file"),
    case(ENDS | {"mesh": "/"}, "rail.mesh", READ + "Is a directory"),
    section("rail.section", "did you mean t_slot?", section={"shape": "t_slo"}),
    section("rail.section", "a DXF or STEP file, or a table", section=3),
    section("rail.section", "a floor with a width", section=SLOTTED | {"web": "12 mm"}),
    section("rail.section.web", "a quantity in m", section=SLOTTED | {"web": "12"}),
    section("rail.section.wall", "no such key", section=SLOTTED | {"wall": "1 mm"}),
    section("rail.section", "three corners or more", section=[["0 mm", "0 mm"]]),
    section("rail.section.0.1", "a quantity in m", section=[["0 mm", "0"]]),
    section("rail.section", "a readable file", section="missing.dxf"),
    section("rail.mounted.0", "nearest side is (4, -20) to", mounted=[["15 mm", "-19 mm"]]),
    section("rail.mounted", "at least one", mounted=[]),
    section("rail.unit", "other than with a file", unit="mm"),
    section("rail.stretch", "greater than or equal to 1", stretch=0.5),
    section("rail.fillet", "no such key with section", fillet="2 mm"),
]
