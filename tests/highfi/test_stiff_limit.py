"""The limit that justifies the surrogate: on the penalty of the reference at rigid walls it is the reference with an infinitely
stiff rail.

A rail of modulus E gives way by force/E, so what that changes of a smooth event falls as 1/E, until penalty, step or quadrature are
larger. The penalty is a hundredth of the catalogue's, for a rail to be stiff beside it; pads are flat and lie on whole facets.
"""

import dataclasses

import numpy as np
import pytest

import highfi
import lowfi
import scenes

STIFFER = (4.0, 16.0, 64.0)
DURATION, APPROACH = 6e-3, 0.01  # s, m/s


def event(start: float, stiffer: float) -> scenes.Scene:
    """A payload without thrust or friction on a fixed platform, that slides at 5 m/s from X = ``start`` (m) and comes against four
    walls."""
    scene = scenes.load("reference")
    raw = {key: value for key, value in scene.resolved().items() if key in ("payload", "rail", "output")}
    raw["rail"]["material"]["youngs_modulus"] *= stiffer
    # Edges of the pads on borders of facets, where no Gauss point is in doubt.
    raw["pads"] = [pad.model_dump(mode="json") | {"relief": 0.0, "inset": 0.01175} for pad in scene.pads]
    raw["contact"] = scene.contact.model_dump(mode="json") | {"penalty": 1.8e10}
    raw["thrust"] = {"kind": "constant", "force": 0.0, "duration": DURATION}
    raw["initial"] = {"position": {"x": start, "z": 0.24e-3}, "velocity": {"x": 5.0, "z": APPROACH}}
    return scenes.parse(raw | {"name": "stiff", "duration": DURATION}, bare_numbers_are_si=True)


def apart(one, other) -> tuple[float, float]:
    """Relative difference of the velocity across, and difference of the rates over APPROACH per 0.1 m."""
    count = min(len(one.time), len(other.time))
    across = np.linalg.norm(one.velocity[:count, 2] - other.velocity[:count, 2]) / np.linalg.norm(one.velocity[:count, 2])
    return across, np.linalg.norm(one.rate[:count] - other.rate[:count]) * 0.1 / APPROACH / np.sqrt(count)


@pytest.mark.slow
@pytest.mark.parametrize("start", [0.0, 0.03], ids=["straight slide", "tip-off"])  # the front pads leave the rail in the second
def test_difference_of_the_fidelities_falls_with_the_stiffness_of_the_rail(start):
    rigid, real = [], []
    for stiffer in STIFFER:
        scene = event(start, stiffer)
        walls = highfi.walls(scene, 0.004)
        at_rest = dataclasses.replace(walls, flexibility=np.zeros_like(walls.flexibility))
        reference = highfi.run(scene, numerics=highfi.Numerics(element_size=0.004, quadrature=4))
        rigid.append(apart(reference, lowfi.run(scene, walls=at_rest)))
        real.append(apart(reference, lowfi.run(scene, walls=walls)))
    slopes = np.diff(np.log(rigid), axis=0) / np.diff(np.log(STIFFER))[:, None]
    assert (slopes < -0.8).all() and (slopes > -1.2).all()
    # Control: with the rail's own flexibility little is left of the difference, so it was the flexibility that made it.
    assert (np.array(real) < 0.1 * np.array(rigid)).all()
