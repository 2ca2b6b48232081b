"""Sobol' indices of the study: file of tolerances, points, rows of overrides, estimators, and the
inputs and base points that are left out."""

import numpy as np
import pytest

from tipoff.lowfi.ensemble.rows import numbers
from tipoff.mechanics.model_names import SPRINGS
from tipoff.scenes import load
from tipoff.scenes.effects import thrust_offset
from tipoff.studies.sensitivity import indices, tolerances

SCENE = load("clamped")
ANGLES = (
    "thrust_offset.misalignment.radial",
    "thrust_offset.eccentricity.radial",
    "mass_offset.eccentricity.radial",
)


def table(key: str, **entries: str) -> str:
    return f'[vary."{key}"]\n' + "".join(f'{name} = "{value}"\n' for name, value in entries.items())


def columns(folder, tables: list[str], count: int) -> np.ndarray:
    """Inputs (count (d + 2), d) of the cases of a file of ``tables``, in the order of the file."""
    path = folder / "tolerances.toml"
    path.write_text("\n".join(tables))
    spread = tolerances.load(path, SCENE)
    rows = spread.rows(indices.points(count, len(spread.inputs), seed=1))
    return numbers([item.key for item in spread.inputs], rows)


def uniform(key: str) -> str:
    return table(key, distribution="uniform", low="-180 deg", high="180 deg")


@pytest.mark.case("O46")
def test_ishigami(tmp_path):
    """Ishigami and Homma 1990, a = 7, b = 0.1. Control: the same values in another order have no
    significant index."""
    x = columns(tmp_path, [uniform(key) for key in ANGLES], 2**14).T
    values = np.sin(x[0]) + 7.0 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0])
    assert values.var() == pytest.approx(13.844588, rel=0.01)
    found = indices.indices(values, 3, seed=1, resamples=20)
    assert found.first == pytest.approx([0.313905, 0.442411, 0.0], abs=0.01)
    assert found.total == pytest.approx([0.557589, 0.442411, 0.243684], abs=0.01)
    assert found.points == 2**14 and min(found.total_half_width) > 0.0
    shuffled = indices.indices(
        np.random.default_rng(1).permutation(values), 3, seed=1, resamples=20
    )
    assert abs(shuffled.total[1] - 0.442411) > 0.3


@pytest.mark.case("O47")
def test_shares_of_the_linear_tip_off(tmp_path):
    """w = (J l/I) t cos f1 + (J/I)(r cos f2 + m cos f3). Neither a size nor its angle acts alone
    (means are zero), so first-order indices are zero and the total index of both is the share of
    their term.

    Error of a total index from n draws, exact moments: half the mean square of c s (z - z') cos f
    has the variance 0.875 (c s)^4, that of c s z (cos f - cos f') 1.4375 (c s)^4, where the term's
    own variance is (c s)^2/2. Sobol' points do better than draws.
    """
    sds = {
        "thrust_offset.misalignment": ("0.13333333333333333 deg", 0.15 * np.deg2rad(0.4 / 3.0)),
        "thrust_offset.eccentricity": ("0.2 mm", 0.2e-3),
        "mass_offset.eccentricity": ("0.13333333333333333 mm", 0.4e-3 / 3.0),
    }
    count, impulse, inertia = 2**13, 100.0, 0.55
    tables = [
        text
        for key, (sd, _) in sds.items()
        for text in (
            table(f"{key}.axial", distribution="normal", mean=f"0 {sd.split()[1]}", sd=sd),
            uniform(f"{key}.radial"),
        )
    ]
    x = columns(tmp_path, tables, count).T
    factors = np.degrees(impulse / inertia * np.array([0.15, 1.0, 1.0]))
    values = sum(
        factor * size * np.cos(angle) for factor, size, angle in zip(factors, x[::2], x[1::2])
    )
    terms = 0.5 * np.degrees(impulse / inertia * np.array([arm for _, arm in sds.values()])) ** 2
    shares = terms / terms.sum()
    assert np.sqrt(terms.sum()) == pytest.approx(3.121965, abs=1e-6)
    assert shares == pytest.approx([0.678342, 0.222686, 0.098972], abs=1e-6)
    found = indices.indices(values, 6, seed=1, resamples=20)
    # E[(c s z cos f)^4] = 9/8 (c s)^4
    fourth = (4.5 * terms**2).sum() + 3.0 * (terms.sum() ** 2 - (terms**2).sum())
    # relative error of the variance the index is divided by
    scale = np.sqrt((fourth / terms.sum() ** 2 - 1.0) / (2 * count))
    for total, factor in ((found.total[::2], np.sqrt(0.875)), (found.total[1::2], np.sqrt(1.4375))):
        assert (
            abs(total - shares) < 3.0 * (2.0 * factor * shares / np.sqrt(count) + shares * scale)
        ).all()
    assert (np.abs(found.first) < 3.0 / np.sqrt(count)).all()


def test_base_points_that_did_not_settle_are_left_out_whole(tmp_path):
    """The same as without these points. Control: a result that does not vary has no indices."""
    x = columns(tmp_path, [uniform(key) for key in ANGLES], 256).T
    values = np.sin(x[0]) + x[1]
    missing = values.copy()
    missing[[7, 333]] = np.nan  # in the blocks 1 and 66
    found = indices.indices(missing, 3, seed=1)
    expected = indices.indices(np.delete(values.reshape(-1, 5), [1, 66], axis=0).ravel(), 3, seed=1)
    assert found.points == 254 and found == expected
    assert indices.indices(np.full(256 * 5, 0.1) * 3.0, 3, seed=1) is None


def test_components_are_those_of_the_effects(tmp_path):
    """A scene with the size and angle of a case has its components; the force at the reference
    penetration does not depend on the exponent."""
    found = tolerances.load(tolerances.DEFAULT, SCENE, SPRINGS)
    points = indices.points(8, len(found.inputs), seed=2)
    drawn = {item.key: item.values(column) for item, column in zip(found.inputs, points.T)}
    assert "contact.interface_stiffness" in found.left_out and len(found.inputs) == 21
    for number, row in enumerate(found.rows(points)):
        scene = SCENE.replace(row)
        direction = thrust_offset.record(scene.thrust_offset, None, 0.1).direction
        size = np.hypot(
            drawn["thrust_offset.misalignment.y"], drawn["thrust_offset.misalignment.z"]
        )[number]
        for axis, name in ((1, "y"), (2, "z")):
            component = drawn[f"thrust_offset.misalignment.{name}"][number]
            assert direction[axis] == pytest.approx(component * np.sin(size) / size, abs=1e-15)
            for kind in ("thrust_offset", "mass_offset"):
                place = getattr(scene, kind).eccentricity.offset()[axis]
                assert place == pytest.approx(
                    drawn[f"{kind}.eccentricity.{name}"][number], abs=1e-12
                )
        force = scene.contact.stiffness * 2e-5**scene.contact.exponent
        assert force == pytest.approx(drawn["contact.stiffness"][number] * 2e-5**1.5, rel=1e-12)


@pytest.mark.parametrize("static", [0.2, 0.3])
def test_static_friction_changes_in_proportion(tmp_path, static):
    """Control: its own distribution is not changed."""
    scene = SCENE.replace({"friction.static": static})
    found = tolerances.load(tolerances.DEFAULT, scene)
    rows = found.rows(indices.points(8, len(found.inputs), seed=1))
    dynamic, rest = numbers(["friction.dynamic", "friction.static"], rows).T
    assert (
        len(set(dynamic)) > 8
        and dynamic.min() < 0.16
        and dynamic.max() > 0.24
        and np.allclose(rest, static / 0.2 * dynamic)
    )
    lowest = {"friction.dynamic": "0.1", "friction.static": "0.3"}
    tables = [
        table(key, distribution="uniform", low=low, high="0.4") for key, low in lowest.items()
    ]
    (tmp_path / "own.toml").write_text("\n".join(tables))
    own = tolerances.load(tmp_path / "own.toml", scene).rows(np.array([[0.25, 0.5]]))
    assert own == [pytest.approx({"friction.dynamic": 0.175, "friction.static": 0.35})]


def test_an_input_that_a_scene_lacks_is_left_out_with_the_reason():
    def left_out(overrides: dict) -> dict[str, str]:
        return tolerances.load(tolerances.DEFAULT, SCENE.replace(overrides)).left_out

    assert left_out({"friction": None})["friction.dynamic"] == "the scene has no friction"
    assert "zero" in left_out({"payload.inertia.xy": 0.0})["payload.inertia.xy"]
    compliant = tolerances.load(tolerances.DEFAULT, SCENE)
    assert "contact.stiffness" in compliant.left_out and "contact.interface_stiffness" in [
        item.key for item in compliant.inputs
    ]


@pytest.mark.parametrize("response", ["additive", "product"])
def test_the_half_width_of_the_sum_is_its_scatter(response):
    """Over draws of random base points the sum of the first-order indices scatters about its value by the half
    width that one draw states. Control: a quarter of the points has twice the half width."""
    inputs, count, sums, widths, fewer = 6, 128, [], [], []
    for seed in range(60):
        first, last = np.random.default_rng(seed).uniform(-0.5, 0.5, (2, count, inputs))
        mixed = [np.where(np.arange(inputs) == n, last, first) for n in range(inputs)]
        x = np.stack([first, *mixed, last], axis=1).reshape(-1, inputs)
        values = x.sum(axis=1) if response == "additive" else x[:, 0] * x[:, 1]
        sums.append(sum(indices.indices(values, inputs, seed=1, resamples=2).first))
        widths.append(indices.sum_half_width(values, inputs, seed=1))
        few = values[: count // 4 * (inputs + 2)]
        fewer.append(indices.sum_half_width(few, inputs, seed=1))
    scatter = 1.96 * np.std(sums)
    assert np.mean(widths) == pytest.approx(scatter, rel=0.25)
    assert np.mean(fewer) == pytest.approx(2.0 * scatter, rel=0.35)
    exact = 1.0 if response == "additive" else 0.0
    assert np.mean(sums) == pytest.approx(exact, abs=scatter / 3.0)
    assert indices.sum_half_width(np.ones(count * (inputs + 2)), inputs, seed=1) is None
