"""Lowest frequencies of the rails of the catalogue, here and in CalculiX.

The reference has lumped masses. CalculiX has consistent masses, and in C3D8I the incompatible modes have
mass of their own::

    [K   L^T] [u]           [M   R^T] [u]
    [L   H  ] [a] = omega^2 [R   S  ] [a],     M, R, S = rho integral of products of the 8 + 3 functions

With this mass on the elements of the reference, a remaining difference comes from the stiffness.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly, vibration
from tipoff.highfi.statics.solve import Clamped
from tipoff.scenes.rail_base import MaterialTable
from validation.peers import calculix
from validation.peers.calculix import LINEAR, QUADRATIC
from validation.peers.calculix_rail import (
    FINEST,
    JOINTS_MATCHED,
    JOINTS_UNMATCHED,
    ON_JOINTS,
    SETTINGS,
    Setting,
    constants,
    rail,
    supported,
)
from validation.peers.case import Case, extrapolated

MODES = 4
_BUBBLES = 3
_BY_SIZE = {4.0: 0.03, 2.0: 0.015, 1.0: 2e-3}
CHANNEL = {
    "C3D8I 4 mm, ours 4 mm": Setting(LINEAR, 4.0, 4.0),
    "C3D8I 2 mm, ours 2 mm": Setting(LINEAR, 2.0, 2.0),
    "C3D20R 4 mm, ours 2 mm": Setting(QUADRATIC, 4.0, 2.0),
}


def here(name: str, chosen: Setting) -> dict[str, float]:
    """Frequencies (Hz) of a rail with the masses of the reference; if both codes have the same
    elements, also with the masses of CalculiX."""
    scene, mesh = rail(name, chosen.ours)
    operator = assembly.of_material(mesh, scene.rail.material, joint=scene.rail.joint())
    clamped = Clamped(operator)
    mass = np.repeat(operator.mass, 3)[clamped.free]
    found, _ = vibration.modes(clamped.stiffness, mass, clamped.solve, MODES)
    named = _named("lumped", found / (2.0 * np.pi))
    if _has_same_mass(chosen):
        named |= _named("with bubbles", _with_bubbles(mesh, scene.rail.material))
    return named


def there(name: str, chosen: Setting) -> dict[str, float]:
    """The same frequencies by CalculiX."""
    scene, mesh = rail(name, chosen.theirs)
    of = calculix.solid(mesh, chosen.kind)
    deck = calculix.head(of, constants(scene.rail.material))
    deck += supported(of, scene, mesh)
    deck += f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"
    answer = calculix.run(deck)
    # mode, eigenvalue, rad/s, Hz, its imaginary part
    found = answer.table("E I G E N V A L U E   O U T P U T", MODES)[:, 3]
    named = _named("lumped", found) | {"cpu_s": answer.cpu_s}
    return named | (_named("with bubbles", found) if _has_same_mass(chosen) else {})


def _has_same_mass(chosen: Setting) -> bool:
    return chosen.kind == LINEAR and chosen.ours == 4.0


def _named(mass: str, frequencies: np.ndarray) -> dict[str, float]:
    return {
        f"f{number + 1}, mass {mass}": value for number, value in enumerate(frequencies.tolist())
    }


def _with_bubbles(mesh: RailMesh, material: MaterialTable) -> np.ndarray:
    """Frequencies (Hz) with the incompatible modes as unknowns that have mass."""
    law = hexahedron.elasticity(material.youngs_modulus, material.poisson_ratio)
    cells = hexahedron.basis(mesh.points[mesh.cells])
    strain = hexahedron.kinematics(cells)
    both = np.concatenate([strain.nodal, strain.bubble], axis=3)
    functions = np.vstack([hexahedron.shape_functions(cells), 4.0 * cells.X * (1.0 - cells.X)])
    products = np.einsum("aq,bq,cq->cab", functions, functions, cells.dx)
    count, width = len(mesh.cells), both.shape[3]
    masses = material.density * np.einsum("cab,ij->caibj", products, np.eye(3))
    inner = len(mesh.points) + np.arange(_BUBBLES * count).reshape(count, _BUBBLES)
    freedom = (3 * np.hstack([mesh.cells, inner])[:, :, None] + np.arange(3)).reshape(count, width)
    free = np.ones(3 * (len(mesh.points) + inner.size), dtype=bool)
    free[(3 * np.unique(mesh.surfaces["mount"])[:, None] + np.arange(3)).ravel()] = False
    stiffness = _assembled(hexahedron.integral(both, law, both, strain.volume), freedom, free)
    mass = _assembled(masses.reshape(count, width, width), freedom, free)
    options = {"SymmetricMode": True}
    factor = splu(stiffness, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=float)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    squares = eigsh(stiffness, MODES, mass, 0.0, v0=start, OPinv=inverse, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)) / (2.0 * np.pi)


def _assembled(blocks: np.ndarray, freedom: np.ndarray, free: np.ndarray) -> csc_array:
    """The matrix of the ``free`` degrees of freedom from blocks (c,w,w) at ``freedom`` (c,w)."""
    width = freedom.shape[1]
    places = np.repeat(freedom, width, axis=1).ravel(), np.tile(freedom, (1, width)).ravel()
    whole = coo_array((blocks.ravel(), places), shape=(free.size, free.size)).tocsr()
    return csc_array(whole[free][:, free])


def cases() -> tuple[Case, ...]:
    """The rails of ``clamped`` and ``channel``, and that of ``reference`` on its joints."""
    joined = _case("reference", ON_JOINTS, {2.0: 0.01, 1.0: 1e-3})
    joined = replace(
        joined,
        title="Lowest frequencies of a rail of scene `reference`, on its joints",
        matched=JOINTS_MATCHED,
        unmatched=f"CalculiX has no lumped masses; {JOINTS_UNMATCHED}",
    )
    return _case("clamped", SETTINGS, _BY_SIZE), _case("channel", CHANNEL, _BY_SIZE, 3e-4), joined


def _case(
    name: str, settings: dict[str, Setting], by_size: dict[float, float], same: float = 1e-6
) -> Case:
    """``by_size``: the largest difference by the size of our elements (mm); ``same``: that with equal
    elements and masses."""

    def within(setting: str, quantity: str) -> float:
        return same if "bubbles" in quantity else by_size[settings[setting].ours]

    distorted = "; C3D8I around the holes, where elements are no bricks" if same > 1e-6 else ""
    has_both = any(map(_has_same_mass, settings.values()))
    kinds = ("lumped", "with bubbles") if has_both else ("lumped",)

    def ours(setting: str) -> dict[str, float]:
        found = here(name, settings[setting])
        if setting != FINEST:
            return found
        return extrapolated(here(name, Setting(QUADRATIC, 2.0, 2.0)), found)

    return Case(
        name=f"calculix-modes-{name}",
        title=f"Lowest frequencies of a rail of scene `{name}`, held at its mounts",
        inputs=lambda: {"scene": name},
        matched="mesh, material, held nodes; in C3D8I the stiffness too; `mass with bubbles`: the "
        "mass of CalculiX in tipoff",
        unmatched=f"`mass lumped`: CalculiX has no lumped masses{distorted}",
        settings=tuple(settings),
        units={f"f{number + 1}, mass {kind}": "Hz" for kind in kinds for number in range(MODES)},
        ours=ours,
        theirs=lambda setting: there(name, settings[setting]),
        within=within,
        slow=tuple(key for key, chosen in settings.items() if chosen.ours < 4.0),
    )
