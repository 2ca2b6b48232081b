"""The chain of layers gives the displacements of a dense solution, for any graph of couplings."""

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array

from tests.highfi.statics.test_vibration import MATERIAL
from tests.highfi.test_compliance import LENGTH, beam, pads
from tipoff.highfi import compliance
from tipoff.highfi.statics import assembly, chain, solve
from tipoff.highfi.statics.held import distinct

WIDTH = 3  # loads of a place
SAME = 1e-9  # relative; the condition numbers are up to 4e6


def extruded() -> csc_array:
    """Stiffness of a beam clamped at one end."""
    operator = assembly.of_material(beam((24, 2, 2)), MATERIAL)
    free = np.repeat(operator.free, 3)
    return csc_array(assembly.sparse(operator)[free][:, free])


def irregular() -> csc_array:
    """Couplings of random pairs of neighbours in a row of 300, and a part without a coupling to the
    others."""
    generator = np.random.default_rng(3)
    size = 300
    rows = generator.integers(0, size, 1500)
    columns = np.clip(rows + generator.integers(-9, 10, rows.size), 0, size - 1)
    apart = (rows < 40) == (columns < 40)
    half = csr_array(
        (generator.standard_normal(apart.sum()), (rows[apart], columns[apart])), shape=(size, size)
    )
    order = generator.permutation(size)
    made = (half @ half.T + csr_array(np.diag(np.full(size, 0.1))))[order][:, order]
    return csc_array(made)


@pytest.fixture(params=[extruded, irregular])
def stiffness(request):
    return request.param()


def test_only_neighbouring_layers_are_coupled(stiffness):
    order = chain.layers(csr_array(stiffness))
    layer = np.empty(stiffness.shape[0], dtype=np.int64)
    layer[np.concatenate(order)] = np.repeat(np.arange(len(order)), [each.size for each in order])
    assert np.array_equal(np.sort(np.concatenate(order)), np.arange(layer.size))
    rows, columns = stiffness.nonzero()
    assert len(order) > 8 and np.abs(layer[rows] - layer[columns]).max() == 1


def test_layers_of_an_extruded_solid_are_its_stations():
    """Whatever node the search begins with."""
    matrix = csr_array(extruded())
    sizes = [layer.size for layer in chain.layers(matrix)]
    assert sizes == [27] * 24
    mixed = np.random.default_rng(0).permutation(matrix.shape[0])
    assert [layer.size for layer in chain.layers(matrix[mixed][:, mixed])] == sizes


def test_a_solution_is_that_of_dense_matrices(stiffness):
    loads = np.random.default_rng(1).standard_normal((stiffness.shape[0], 4))
    exact = np.linalg.solve(stiffness.toarray(), loads)
    found = chain.Chain(stiffness, chain.layers(csr_array(stiffness)))
    assert np.abs(found.solve(loads) - exact).max() < SAME * np.abs(exact).max()
    assert found.solve(loads[:, 0]) == pytest.approx(exact[:, 0], abs=SAME * np.abs(exact).max())


@pytest.mark.parametrize("share", [1.0, 0.1])
def test_displacements_under_places_are_those_of_dense_matrices(stiffness, share):
    """For every pair of places: in the same layers, in overlapping ones and far apart; with loads on many
    and on few degrees of freedom, so blocks have more and fewer columns than a layer."""
    order = chain.layers(csr_array(stiffness))
    generator, count = np.random.default_rng(2), 12
    dense = np.zeros((stiffness.shape[0], count, WIDTH))
    for place in range(count):
        first = generator.integers(0, len(order))
        for layer in order[first : first + generator.integers(1, 6)]:
            own = layer[generator.random(layer.size) < share]
            dense[own, place] = generator.standard_normal((own.size, WIDTH))
    loads = dense.reshape(len(dense), -1)
    exact = (loads.T @ np.linalg.solve(stiffness.toarray(), loads)).reshape(2 * (count, WIDTH))
    pairs = np.stack(np.divmod(generator.permutation(count**2)[:100], count), axis=1)
    expected = exact[pairs[:, 0], :, pairs[:, 1]]

    def error(factor: chain.Chain) -> float:
        found = factor.under(csc_array(loads), pairs, WIDTH, seen.append)
        return np.abs(found - expected).max() / np.abs(exact).max()

    seen: list[float] = []
    factor = chain.Chain(stiffness, order)
    assert error(factor) < SAME
    assert seen == sorted(seen) and seen[-1] == 1.0


def test_places_without_a_load_do_not_move(stiffness):
    """As over a mount alone, beside others and alone."""
    order = chain.layers(csr_array(stiffness))
    factor, loads = chain.Chain(stiffness, order), np.zeros((stiffness.shape[0], 2 * WIDTH))
    pairs = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
    assert not factor.under(csc_array(loads), pairs, WIDTH, lambda _: None).any()
    loads[order[-2], :WIDTH] = 1.0
    found = factor.under(csc_array(loads), pairs, WIDTH, lambda _: None)
    own = loads[:, :WIDTH]
    exact = own.T @ np.linalg.solve(stiffness.toarray(), own)
    assert found[0] == pytest.approx(exact, rel=1e-6) and not found[1:].any()


def test_both_factors_give_the_same_compliance(monkeypatch):
    def found():
        return compliance.of_rails(
            distinct(beam((40, 2, 2)), MATERIAL),
            pads(0.21, 0.45),
            (0.0, LENGTH),
            (0.0, 0.03, 0.2),
            modes=6,
        )

    sparse = found()
    monkeypatch.setattr(solve, "is_cheaper", lambda order, loads: True)
    made = []
    monkeypatch.setattr(solve, "Chain", lambda *given: made.append(given) or chain.Chain(*given))
    block = found()
    assert len(made) == 1
    for name in ("matrix", "gram", "frequency", "warm"):
        values = getattr(sparse, name)
        assert np.abs(getattr(block, name) - values).max() <= SAME * np.abs(values).max(), name
    # the signs of the modes too
    assert block.shape == pytest.approx(sparse.shape, abs=1e-6 * np.abs(sparse.shape).max())


def test_long_rails_with_many_loads_are_chains():
    """Short ones, few loads and wide layers are not."""

    def stations(count: int, width: int) -> list[np.ndarray]:
        return [np.arange(width)] * count

    assert chain.is_cheaper(stations(500, 200), 7000)
    assert not chain.is_cheaper(stations(500, 200), 10)
    assert not chain.is_cheaper(stations(20, 30), 50)
    assert not chain.is_cheaper(stations(20, 20_000), 7000)
