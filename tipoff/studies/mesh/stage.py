"""Stage ``mesh``: the mesh of the rails for the reference, its size and quality."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tipoff.files import replacing
from tipoff.workspace.progress import say
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study


@dataclass(frozen=True)
class Surface:
    """A named surface; the area of the same faces of a solid, None without one."""

    facets: int
    area_m2: float
    drawn_area_m2: float | None


@dataclass(frozen=True, kw_only=True)
class Deck:
    """The first rail as a ``file`` of CalculiX and Abaqus, and the answers of the reference: mean
    deflection of the wall under ``force_n`` on the first pad, and lowest frequencies."""

    file: str
    force_n: float
    deflection_m: float
    frequencies_hz: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """``surfaces`` by name; ``low_m`` and ``high_m`` the least and largest coordinates in scene
    axes; ``mesh`` is a file in the folder of the scene."""

    element_size_m: float
    elements: int
    kind: str
    nodes: int
    shortest_edge_m: float
    longest_edge_m: float
    smallest_scaled_jacobian: float
    low_m: tuple[float, ...]
    high_m: tuple[float, ...]
    warnings: tuple[str, ...]
    surfaces: dict[str, Surface]
    mesh: str
    deck: Deck | None  # None if no pad is on the first rail


def _request(study: Study) -> Run:
    return study.highfi(next(iter(study.conditions)))


STAGE = Stage("mesh", __name__, inputs=lambda study, _: _request(study).key, result=Mesh)


def run(study: Study) -> Made[Mesh]:
    """The mesh; writes ``mesh.vtu`` and ``rail.inp``."""
    request = _request(study)

    def make() -> tuple[Mesh, list[Path]]:
        from tipoff import highfi
        from tipoff.highfi.mesh import cells as checks
        from tipoff.highfi.mesh import facets

        mesh = highfi.prepare(request.scene, request.numerics)
        for warning in mesh.warnings:
            say(f"mesh: {warning}")
        path = study.path("mesh.vtu")
        _save(mesh, path)
        lengths = checks.edge_lengths(mesh.points, mesh.cells)
        _, scaled = checks.jacobians(mesh.points, mesh.cells)
        surfaces = {
            name: Surface(
                len(group),
                facets.area(mesh.points, group),
                mesh.drawn[name] if mesh.drawn else None,
            )
            for name, group in mesh.surfaces.items()
        }
        found = Mesh(
            element_size_m=request.numerics.element_size,
            elements=len(mesh.cells),
            kind=checks.kind(mesh.cells).name,
            nodes=len(mesh.points),
            shortest_edge_m=float(lengths.min()),
            longest_edge_m=float(lengths.max()),
            smallest_scaled_jacobian=float(scaled.min()),
            low_m=tuple(mesh.points.min(axis=0).tolist()),
            high_m=tuple(mesh.points.max(axis=0).tolist()),
            warnings=tuple(mesh.warnings),
            surfaces=surfaces,
            mesh=study.relative(path),
            deck=_deck(study, request),
        )
        decks = [study.path(found.deck.file)] if found.deck else []
        return found, [path, *decks]

    return STAGE.run(study, None, make)


def _deck(study: Study, request: Run) -> Deck | None:
    from tipoff.studies.mesh import deck

    path = study.path("rail.inp")
    found = deck.write(request.scene, request.numerics.element_size, path)
    if found is None:
        return None
    return Deck(
        file=study.relative(path),
        force_n=deck.FORCE,
        deflection_m=found.deflection,
        frequencies_hz=found.frequencies,
    )


def _save(mesh, path: Path) -> None:
    import meshio

    from tipoff.highfi.mesh.cells import kind

    names = list(mesh.surfaces)
    facets = np.concatenate([mesh.surfaces[name] for name in names])
    group = np.concatenate(
        [np.full(len(mesh.surfaces[name]), index + 1) for index, name in enumerate(names)]
    )
    document = meshio.Mesh(
        mesh.points,
        [(kind(mesh.cells).cell, mesh.cells), (kind(mesh.cells).facet, facets)],
        cell_data={"surface": [np.zeros(len(mesh.cells), dtype=int), group]},
    )
    with replacing(path) as temporary:
        document.write(temporary, file_format="vtu")
