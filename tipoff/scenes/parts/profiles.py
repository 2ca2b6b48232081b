"""Profiles with a T-slot, and materials of buttons, lugs and rods, by the names that shops use."""

from typing import Literal, NamedTuple, get_args

ProfileName = Literal["1010", "1515", "4040 slot 8"]
MaterialName = Literal["acetal", "nylon", "aluminium"]


class Profile(NamedTuple):
    """Dimensions (m) of a square profile, and of a button that fits its slot."""

    width: float  # of the profile
    slot: float  # between the lips
    lip: float  # thickness
    cavity: float  # width behind the lips
    depth: float  # of the floor of the slot below the outside
    web: float  # thickness of the diagonal webs
    head: float  # diameter of the head and of the flange of a button
    source: str


_DRAWN = "80/20 profiles as drawn in inc/conf_extrusion.scad of StephS/3d-printer: slot, cavity"
PROFILES = {
    "1010": Profile(
        0.0254,
        0.006477,
        0.00221,
        0.014859,
        0.00819,
        0.002,
        0.0111,
        f"{_DRAWN}, lip and core; assumed: web",
    ),
    "1515": Profile(
        0.0381,
        0.008128,
        0.00368,
        0.020574,
        0.0123,
        0.0025,
        0.0159,
        f"{_DRAWN} and core; assumed: lip and web",
    ),
    "4040 slot 8": Profile(
        0.040,
        0.008,
        0.0045,
        0.020,
        0.0125,
        0.0025,
        0.015,
        "40 mm profiles of several makers, such as 80/20 40-4040: width and slot; open models of them: "
        "cavity; assumed: depth, lip and web",
    ),
}
assert set(PROFILES) == set(get_args(ProfileName))

RAIL_MATERIAL = {
    "density": "2700 kg/m**3",
    "youngs_modulus": "70 GPa",
    "poisson_ratio": 0.33,
    "yield_strength": "195 MPa",
}
RAIL_SOURCE = "assumed: EN AW-6060, technical data of profiles"
ROD_MATERIAL = {
    "density": "7900 kg/m**3",
    "youngs_modulus": "200 GPa",
    "poisson_ratio": 0.3,
    "yield_strength": "190 MPa",
}
ROD_SOURCE = "assumed: stainless steel 1.4301, values of EN 10088"
# law of the springs between a plastic layer and the lip, as on the scene rocket_rail
CONTACT = {
    "law": "impact",
    "exponent": 1.5,
    "stiffness": "5000 N/mm**1.5",
    "damping": "2 N*s/mm",
    "damping_depth": "0.1 mm",
    "interface_stiffness": "1e13 N/m**3",
}
_LAYER = {"thickness": "4 mm", "youngs_modulus": "3 GPa"}
MATERIALS: dict[str, dict] = {
    "acetal": CONTACT | {"pad_layer": _LAYER},
    "nylon": CONTACT | {"pad_layer": _LAYER | {"youngs_modulus": "2.5 GPa"}},
    "aluminium": CONTACT | {"stiffness": "70000 N/mm**1.5", "interface_stiffness": "1.8e12 N/m**3"},
}
assert set(MATERIALS) == set(get_args(MaterialName))
FRICTION = {"static_speed": "10 mm/s", "dynamic_speed": "20 mm/s"}
