"""Rails with a section of their own: an L of corners against the built-in one, a slender cantilever
against a beam and a finer mesh, and pads without a wall."""

from dataclasses import replace

import numpy as np
import pytest

from tests.formats.test_outline import shape, table
from tests.meshes.test_profile import MATERIAL, of
from tests.scenes.section_shapes import SHAPES
from tipoff import highfi
from tipoff.highfi import compliance
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.simulation import prepare
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.solve import Clamped
from tipoff.meshes import profile
from tipoff.scenes import SceneError, load, parse

COARSE = Numerics(element_size=0.008)


def as_corners(scene, **keys):
    """``scene`` with its sharp L sections given by corners, those of its mounted strips too."""
    raw = scene.resolved()
    rail, corner = raw["rail"], raw["pads"][0]["position"][1:]
    leg, thickness, strip = (rail[key] for key in ("leg", "thickness", "mount_width"))
    outer = [abs(place) + raw["contact"]["clearance"] + thickness for place in corner]
    section = [[0.0, 0.0], [-strip, 0.0], [-leg, 0.0], [-leg, -thickness], [-thickness, -thickness]]
    section += [[-thickness, -leg], [0.0, -leg], [0.0, -strip]]
    own = {key: rail[key] for key in ("start", "end", "material", "mounts", "leg", "thickness")}
    own |= {"section": section, "at": outer, "mirrored": ["y", "z"]}
    raw["rail"] = own | {"mounted": [[-strip / 2, 0.0], [0.0, -strip / 2]]} | keys
    return parse(raw, bare_numbers_are_si=True)


@pytest.mark.parametrize("size", [0.008, 0.004])
def test_an_l_of_corners_has_the_compliance_of_the_built_in_one(size):
    """The same grid, made in another way: equal up to rounding."""
    scene = load("tiny")
    built, own = (compliance.condense(each, size, 0.02) for each in (scene, as_corners(scene)))
    scale = np.abs(built.flexibility).max()
    assert np.abs(own.flexibility - built.flexibility).max() < 1e-11 * scale
    assert own.drawn is None


def test_an_l_of_corners_gives_the_rates_of_the_built_in_one():
    scene = load("tiny")
    built, own = (highfi.run(each, COARSE).outcome for each in (scene, as_corners(scene)))
    assert own.rate == pytest.approx(built.rate, rel=1e-9)


def test_a_payload_that_touches_nothing_needs_no_walls():
    """As in the ablation: the same mesh, and the flight of the built-in section."""
    free = {"contact": None, "friction": None}
    scene = load("tiny")
    built, own = (
        highfi.run(each.replace(free), COARSE).outcome for each in (scene, as_corners(scene))
    )
    assert own.rate == pytest.approx(built.rate, rel=1e-9)
    touching, apart = (
        prepare(each, COARSE) for each in (as_corners(scene), as_corners(scene).replace(free))
    )
    np.testing.assert_array_equal(apart.points, touching.points)


def deflection(name, size, length, stretch):
    """Deflections (m) along Y and Z of the end of a cantilever under 1 N on its end, evenly."""
    outline, blocks = shape(**SHAPES[name]), table(**SHAPES[name]).blocks()
    rail = of(outline, blocks=blocks, ends=(0.0, length), spans=((0.0, 0.02),), stretch=stretch)
    mesh = read(profile.build(rail, size))
    clamped = {"end": np.flatnonzero(mesh.points[:, 0] < 1e-9)}
    held = Clamped(assembly.build(replace(mesh, surfaces=clamped), *MATERIAL, fixed=("end",)), 1000)
    end = mesh.points[:, 0] > length - 1e-9
    # of the end face: the volume of the elements at each node is its share of the area
    share = np.where(end, assembly.build(mesh, *MATERIAL).mass, 0.0)
    load_ = np.zeros((len(mesh.points), 3, 2))
    for case in (0, 1):
        load_[:, 1 + case, case] = share / share.sum()
    load_ = load_.reshape(-1, 2)[held.free]
    return np.diag(load_.T @ held.solve(load_))


@pytest.mark.case("O82")
@pytest.mark.parametrize("name", ["t_slot", "tee", "box"])
def test_a_slender_cantilever_bends_as_a_beam_does(name):
    """F l^3 / 3 E J: shear adds 3 E J / (kappa G A l^2), below 0.6 % here, and a mesh of elements with
    12 mm length is too stiff by less than that. Sections are symmetric in Y, so Y and Z are
    principal axes."""
    length, young = 0.8, MATERIAL[1]
    exact = shape(**SHAPES[name]).moments()
    beam = length**3 / (3.0 * young * np.array([exact.yy, exact.zz]))
    assert deflection(name, 0.003, length, 4.0) == pytest.approx(beam, rel=0.01)


@pytest.mark.case("O82")
def test_a_rod_bends_as_a_round_beam_does():
    """F l^3 / 3 E J of the circle. Layers of one diameter are too stiff by 1.5 %, of half of it by 0.6 %. Control:
    layers of 2.5 diameters are too stiff by more than 6 %."""
    length, radius = 0.8, 0.5 * SHAPES["rod"]["diameter"]
    beam = length**3 / (3.0 * MATERIAL[1] * 0.25 * np.pi * radius**4)
    assert deflection("rod", 0.0015, length, 4.0) == pytest.approx(beam, rel=0.007)
    assert deflection("rod", 0.003, length, 4.0) == pytest.approx(beam, rel=0.016)
    # Control:
    assert (deflection("rod", 0.006, length, 5.0) < 0.94 * beam).all()


@pytest.mark.slow
def test_the_lips_of_a_slot_converge_with_the_elements():
    """The deflection of a short cantilever, in which shear and the section's own deformation count,
    on 3 mm and on half of that: one element through a lip is 3 % too stiff."""
    coarse, fine = (deflection("t_slot", size, 0.08, 4.0) for size in (0.003, 0.0015))
    assert coarse == pytest.approx(fine, rel=0.04)


def test_a_pad_without_a_wall_is_named_with_the_nearest_side():
    scene = as_corners(load("tiny"), at=[0.11, 0.11])
    with pytest.raises(SceneError) as error:
        prepare(scene, COARSE)
    faults = error.value.faults
    assert len(faults) == 16 and faults[0].key == "pads.0"
    assert "the nearest one that faces it is at -0.106 m" in faults[0].expected


def test_a_section_that_nothing_holds_is_refused():
    scene = as_corners(load("tiny"), mounts=[])
    with pytest.raises(SceneError, match=r"rail\.mounts: given none"):
        prepare(scene, COARSE)


def test_a_mesh_that_does_not_fit_into_memory_is_refused_before_it_is_made():
    with pytest.raises(SceneError, match="element_size"):
        prepare(as_corners(load("tiny")), replace(COARSE, element_size=5e-5))
