"""``[rail]`` of a section of the catalogue, with its damping and the stiffness of its mounts."""

from tests.scenes.refusals import case
from tests.scenes.support import small
from tipoff.scenes import parse


def made(change: dict):
    return parse(small(**change))


def rail(keys: str, *words: str, **changed):
    return case({f"rail__{key}": item for key, item in changed.items()}, keys, *words)


def damped(keys: str, *words: str, ratios=(0.01, 0.01), frequencies=("500 Hz", "5 kHz")):
    table = {"ratios": list(ratios), "frequencies": list(frequencies)}
    return rail(keys, *words, damping=table)


def jointed(keys: str, **changed):
    return rail(keys, mount_stiffness={"normal": "1e13 N/m^3", "shear": "5000 N/mm^3"} | changed)


RATIOS, FREQUENCIES = "rail.damping.ratios", "rail.damping.frequencies"
NORMAL, SHEAR = "rail.mount_stiffness.normal", "rail.mount_stiffness.shear"
CASES = [
    case({"rail": {}}, "rail.start rail.end rail.material"),
    rail("rail.end", end="-0.2 m"),
    rail("rail.thickness", thickness="24 mm"),
    rail("rail.thickness", thickness="1 nm"),
    rail("rail.thickness", leg="4 mm", thickness="3.9999999 mm"),
    rail("rail.end", start="0 nm", end="1 nm"),
    rail("rail.mount_width", mount_width="25 mm"),
    rail("rail.mount_width", mount_width="0.9 um"),
    rail("rail.mounts", mounts="all"),
    rail("rail.mounts", mounts=[{"start": "0 m", "end": "0.3 m"}]),
    rail("rail.mounts.0.end", mounts=[{"start": "2 m", "end": "1 m"}]),
    rail("rail.mounts.0.end", mounts=[{"start": "0 mm", "end": "1 nm"}]),
    rail("rail.fillet", "greater than or equal to", fillet="0 mm"),
    rail("rail.fillet", "at most 1.25 times the thickness, 0.005 m", fillet="5.1 mm"),
    rail("rail.fillet", "less than the inside of the leg, 0.003 m", fillet="3 mm", leg="7 mm"),
    # a fillet of a wrong leg is not a second fault
    rail("rail.leg", fillet="2 mm", leg="0 mm"),
    rail(f"{FREQUENCIES} {RATIOS}", damping={}),
    rail(FREQUENCIES, "this key", damping={"ratios": [0.01, 0.01]}),
    damped(FREQUENCIES, frequencies=["5 kHz", "500 Hz"]),
    damped(f"{FREQUENCIES}.0", frequencies=["0 Hz", "500 Hz"]),
    damped(f"{FREQUENCIES}.0", frequencies=["5 rad/s", "500 Hz"]),
    damped(
        f"{RATIOS}.0 {RATIOS}.1 {FREQUENCIES}.0 {FREQUENCIES}.1",
        ratios=[-0.01, 1.0],
        frequencies=["-1 Hz", "5 kg"],
    ),
    damped(RATIOS, ratios=[0.0, 0.01]),
    damped(f"{RATIOS}.1", ratios=[0.01]),
    damped(FREQUENCIES, ratios=[0.01, 0.5], frequencies=["500 Hz", "500 Hz"]),
    # no mode may gain energy: just beyond ten times the other ratio, and a tenth of it
    damped(RATIOS, "from 0.001 to 0.1", ratios=[0.01, 0.100001]),
    damped(RATIOS, "from 0.001 to 0.1", ratios=[0.01, 0.000999]),
    rail(f"{NORMAL} {SHEAR}", mount_stiffness={}),
    rail(SHEAR, mount_stiffness={"normal": "1e13 N/m^3"}),
    jointed("rail.mount_stiffness.factor", factor=0.0),
    *(jointed(SHEAR, shear=text) for text in ("0 N/m^3", "-1 N/m^3", "1e13 N/m", "inf N/m^3")),
]
