"""X19: bad input is refused before anything is stepped, in one error that lists every bad field."""

import pytest

from tests.scenes import refusals
from tests.scenes.support import CONTACT, FRICTION, refused, small, write
from tipoff.scenes import SceneError, load, parse
from tipoff.scenes.variation import Variations

pytestmark = pytest.mark.case("X19")

# of each module of ``refusals``
TABLES = [
    pytest.param(module.made, asked, id=f"{name} {number} {asked.keys[:40]}")
    for name, module in refusals.modules()
    for number, asked in enumerate(module.CASES)
]
PLATFORM = {"mass": "80 kg", "inertia": {"xx": "5 kg*m**2", "yy": "5 kg*m**2", "zz": "5 kg*m**2"}}

# key of the fault: (where it is put, what is given, a word of what is expected)
BAD = {
    "payload.mass": ("payload__mass", "9.9 m", "quantity in kg"),
    "payload.inertia": (
        "payload__inertia",
        {"xx": "1 kg*m**2", "yy": "1 kg*m**2", "zz": "3 kg*m**2"},
        "triangle inequality I1 + I2 >= I3 (its principal moments are 1, 1, 3 kg m2)",
    ),
    "platform.inertia": (
        "platform__inertia",
        {"xx": "1 kg*m**2", "yy": "1 kg*m**2", "zz": "1 kg*m**2", "xy": "2 kg*m**2"},
        "positive definite inertia tensor (its principal moments are -1, 1, 3 kg m2)",
    ),
    "payload.size.1": ("payload__size", ["1 m", "0 m", "1 m"], "greater than 0"),
    "payload.colour": ("payload__colour", "red", "no such key"),
    "pads.0.position.2": ("pads", [{"position": ["0 m", "0 m"], "normals": ["+y"]}], "this key"),
    "rail.material.density": ("rail__material__density", "-1 kg/m**3", "greater than 0"),
    "rail.material.youngs_modulus": ("rail__material__youngs_modulus", "inf Pa", "quantity in Pa"),
    "rail.material.poisson_ratio": ("rail__material__poisson_ratio", 0.5, "less than 0.5"),
    "rail.mounts": (
        "rail__mounts",
        [{"start": "10 mm", "end": "30 mm"}, {"start": "20 mm", "end": "40 mm"}],
        "do not overlap",
    ),
    "rail.damping.frequencies": (
        "rail__damping__frequencies",
        ["5 kHz", "5 kHz"],
        "the lower one first",
    ),
    "rail.damping.ratios.1": ("rail__damping__ratios", [0.01, 1.0], "less than 1"),
    "thrust.peak": ("thrust__peak", float("nan"), "quantity in N"),
    "thrust.width": ("thrust__width", "0 ms", "greater than 0"),
    "contact.stiffness": ("contact__stiffness", "-5 N/mm**1.5", "greater than 0"),
    "contact.clearance": ("contact__clearance", "-0.1 mm", "greater than or equal to 0"),
    "friction.static": ("friction__static", -0.1, "greater than or equal to 0"),
    "friction.dynamic_speed": ("friction__dynamic_speed", "5 mm/s", "above static_speed"),
    "platform.mass": ("platform__mass", "0 kg", "greater than 0"),
    "gravity": ("gravity", {}, "at least one key"),
    "initial": ("initial", 3, "a table"),
    "mass_offset.eccentricity.axial": (
        "mass_offset__eccentricity__axial",
        "-1 mm",
        "greater than or equal to 0",
    ),
    "output.interval": ("output__interval", 5e-5, "text with a unit"),
    "thrust_offset.misalignment.axial": (
        "thrust_offset__misalignment__axial",
        "0.1",
        "quantity in rad",
    ),
    "duration": ("duration", True, "quantity in s"),
}
# Duration and sampling interval together: values, and the text of the fault.
BAD_SAMPLING = [
    ({"output__interval": "31 ms"}, "output.interval", "0.031 s", "3e-08 s to 0.03 s"),
    (
        {"output__interval": "29 ns"},
        "output.interval",
        "2.9e-08 s",
        "at most 1,000,000 samples in the duration of 0.03 s",
    ),
    (
        {"output__interval": "1e-30 s"},
        "output.interval",
        "1e-30 s",
        "at most 1,000,000 samples",
    ),
    ({"output__interval": "0 s"}, "output.interval", "'0 s'", "greater than 0"),
    ({"output__interval": "-1 ms"}, "output.interval", "'-1 ms'", "greater than 0"),
    # the interval of a scene that names none
    ({"duration": "40 us"}, "output.interval", "5e-05 s", "1"),
    ({"duration": "3601 s", "output__interval": "1 s"}, "duration", "'3601 s'", "3600"),
]


def whole(**tables) -> dict:
    return small(
        **{
            "contact": dict(CONTACT),
            "friction": dict(FRICTION),
            "platform": dict(PLATFORM),
            "rail__damping": {"frequencies": ["500 Hz", "5 kHz"], "ratios": [0.01, 0.01]},
        }
        | tables
    )


def test_the_sound_scene_passes():
    assert parse(whole()).platform.mass == 80.0


def test_every_bad_field_is_in_one_error():
    raw = whole(**{place: value for place, value, _ in BAD.values()})
    with pytest.raises(SceneError) as caught:
        parse(raw, "file.toml")
    faults = {fault.key: fault for fault in caught.value.faults}
    assert set(faults) == set(BAD)
    text = str(caught.value)
    assert text.startswith(f"{len(BAD)} faults in the scene")
    for key, (_, _, expected) in BAD.items():
        assert expected in faults[key].expected
        assert str(faults[key]) in text and faults[key].source == "file.toml"
    for word in ("Traceback", "pydantic", "ValidationError", "Table", "line ", "type=", "0x"):
        assert word not in text


@pytest.mark.parametrize(("made", "asked"), TABLES)
def test_a_table_is_refused_with_the_keys_of_its_faults(tmp_path, made, asked):
    """Exactly these."""
    with pytest.raises(SceneError) as caught:
        made(refusals.in_folder(asked.change, tmp_path))
    assert sorted(fault.key for fault in caught.value.faults) == sorted(asked.keys.split())
    assert [words for words in asked.words if words not in str(caught.value)] == []


@pytest.mark.parametrize("key", BAD)
def test_each_bad_field_alone(key):
    place, value, expected = BAD[key]
    (fault,) = refused(whole(**{place: value}))
    assert fault.key == key
    assert expected in fault.expected


@pytest.mark.parametrize("tables, key, given, expected", BAD_SAMPLING)
def test_bad_sampling(tables, key, given, expected):
    """In a file, by an override and in a row of an ensemble, beside another fault of the same
    file."""
    (fault,) = refused(whole(**tables))
    assert (fault.key, fault.given) == (key, given) and expected in fault.expected
    assert {fault.key for fault in refused(whole(payload__mass="0 kg", **tables))} == {
        key,
        "payload.mass",
    }
    row, scene = (
        {place.replace("__", "."): value for place, value in tables.items()},
        parse(whole()),
    )
    for change in (scene.replace, Variations(scene).of):
        with pytest.raises(SceneError) as caught:
            change(row)
        assert [fault.key for fault in caught.value.faults] == [key]


@pytest.mark.parametrize(
    "interval, samples", [("30 ms", 1), ("29 ms", 1), ("0.1 ms", 300), ("30 ns", 1_000_000)]
)
def test_sound_sampling(interval, samples):
    """Both ends of what is allowed, and an interval that does not divide the duration."""
    scene = parse(whole(output__interval=interval))
    assert scene.output.last(scene.duration) == samples


def test_a_row_is_refused_after_rows_of_the_same_keys():
    """Later rows are checked number by number; the row after a bad one is sound again."""
    variations = Variations(parse(whole()))
    assert [
        variations.of({"output.interval": value}).output.interval for value in (1e-4, 2e-4)
    ] == [1e-4, 2e-4]
    for bad in (1.0, 1e-9):
        with pytest.raises(SceneError, match="output.interval"):
            variations.of({"output.interval": bad})
    assert variations.of({"output.interval": 3e-4}).output.interval == 3e-4


POSITIVE = [
    "payload__mass kg",
    "payload__inertia__xx kg*m**2",
    "rail__material__density kg/m**3",
    "rail__material__youngs_modulus Pa",
    "contact__stiffness N/m**1.5",
    "contact__interface_stiffness N/m**3",
    "thrust__width s",
    "friction__static_speed m/s",
    "duration s",
]
NOT_NEGATIVE = [
    "contact__clearance m",
    "contact__damping N*s/m",
    "friction__static dimensionless",
    "pads__0__relief m",
]


NO_SIZE = [
    (place, number) for place in POSITIVE + NOT_NEGATIVE for number in ("nan", "inf", "-inf", "-1")
]


@pytest.mark.parametrize("place, number", NO_SIZE + [(place, "0") for place in POSITIVE])
def test_numbers_that_are_no_size(place, number):
    place, unit = place.split()
    key = place.replace("__", ".")
    for bad in (float(number), number if unit == "dimensionless" else f"{number} {unit}"):
        with pytest.raises(SceneError) as caught:
            parse(whole()).replace({key: bad})
        assert [fault.key for fault in caught.value.faults] == [key]


def test_a_naive_reader_lets_nan_and_a_wrong_unit_through():
    """Control: float() and a comparison, the usual way to check, pass what is refused above."""
    mass = float("nan")
    assert not mass <= 0.0
    assert float(["9.9", "m"][0]) == 9.9


@pytest.mark.parametrize(
    "ratio, sound",
    [(0.5, False), (0.7, False), (-1.0, False), (0.499, True), (-0.999, True), (0.0, True)],
)
def test_poisson_ratio_on_both_sides_of_its_bounds(ratio, sound):
    raw = small(rail__material__poisson_ratio=ratio)
    assert (
        parse(raw).rail.material.poisson_ratio == ratio
        if sound
        else refused(raw)[0].key == "rail.material.poisson_ratio"
    )


@pytest.mark.parametrize("zz, sound", [(2.0, True), (2.0 + 1e-9, False)])
def test_triangle_inequality_on_both_sides(zz, sound):
    raw = small(payload__inertia={"xx": "1 kg*m**2", "yy": "1 kg*m**2", "zz": f"{zz!r} kg*m**2"})
    assert parse(raw) if sound else refused(raw)[0].key == "payload.inertia"


CONDITION_FAULTS = {
    "output.interval": 1e-4,
    "payload.mass": "1 m",
    "friction.static": 0.1,
    "thrust.pek": "1 N",
    "pads.7.relief": "1 um",
    "gravty": "absent",
}


def test_conditions_are_checked_when_the_scene_is_read():
    """A bare number is refused in a file's conditions as anywhere else in it, and so is a key that
    does not exist."""
    raw = small(
        payload__inertia__xx="1 kg",
        conditions={"a": CONDITION_FAULTS, "b": {"payload.mass": "11 kg"}},
    )
    keys = {fault.key for fault in refused(raw)}
    assert keys == {
        "payload.inertia.xx",
        *(f"conditions.a.{key}" for key in CONDITION_FAULTS if key != "friction.static"),
        "conditions.a.friction.dynamic",
        "conditions.a.friction.static_speed",
        "conditions.a.friction.dynamic_speed",
    }


def test_conditions_given_by_a_program_may_be_numbers():
    scene = parse(small()).replace({"conditions.a": {"payload.mass": 11.0}})
    assert scene.condition("a").payload.mass == 11.0
    with pytest.raises(SceneError, match="conditions.a.payload.mass"):
        scene.replace({"conditions.a": {"payload.mass": -11.0}})


def test_faults_of_files_name_the_requested_file(tmp_path):
    write(tmp_path, "base.toml", 'extends = "reference"\n[contact]\nclearance = "1 kg"\n')
    child = write(tmp_path, "child.toml", 'extends = "base.toml"\n[payload]\nmass = "0 kg"\n')
    with pytest.raises(SceneError) as caught:
        load(child)
    assert {(fault.source, fault.key) for fault in caught.value.faults} == {
        (str(child), "payload.mass"),
        (str(child), "contact.clearance"),
    }


@pytest.mark.parametrize(
    "text, key, given",
    [
        ('extends = "nowhere"\n', "extends", "nowhere"),
        ("extends = 3\n", "extends", "3"),
        ('extends = "self.toml"\n', "extends", "self.toml"),
        ("payload = [\n", "file", "Invalid value"),
        ('extends = "broken.toml"\n', "extends", "broken.toml"),
    ],
)
def test_files_that_cannot_be_read(tmp_path, text, key, given):
    write(tmp_path, "broken.toml", "= 1")
    path = write(tmp_path, "self.toml", text)
    with pytest.raises(SceneError) as caught:
        load(path)
    (fault,) = caught.value.faults
    assert (fault.source, fault.key) == (str(path), key)
    assert given in fault.given


def test_unknown_names_and_paths(tmp_path):
    with pytest.raises(SceneError, match="one of .*reference"):
        load("refrence")
    with pytest.raises(SceneError, match="No such file"):
        load(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xff")
    with pytest.raises(SceneError, match="valid TOML"):
        load(tmp_path / "bytes.toml")
