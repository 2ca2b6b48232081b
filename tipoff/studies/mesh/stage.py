"""Stage ``mesh``: the mesh of the rails for the reference, its size and quality, and pictures."""

from pathlib import Path

import numpy as np

from tipoff.files import replacing
from tipoff.workspace.progress import say
from tipoff.workspace.study import Study


def run(study: Study) -> dict:
    """Elements, nodes, areas of named surfaces, quality; writes ``mesh.vtu`` and pictures."""
    name = next(iter(study.conditions))
    request = study.highfi(name)

    def make() -> tuple[dict, list[Path]]:
        from tipoff import highfi
        from tipoff.highfi.mesh import cells as checks
        from tipoff.highfi.mesh import facets

        mesh = highfi.prepare(request.scene, request.numerics)
        for warning in mesh.warnings:
            say(f"mesh: {warning}")
        from tipoff.studies.mesh.picture import draw

        path, folder = study.path("mesh.vtu"), study.path("figures")
        pictures = [folder / "mesh.png", folder / "mesh-dark.png"]
        _save(mesh, path)
        for picture, dark in zip(pictures, (False, True)):
            draw(mesh, picture, dark)
        lengths = checks.edge_lengths(mesh.points, mesh.cells)
        _, scaled = checks.jacobians(mesh.points, mesh.cells)
        surfaces = {
            name: {
                "facets": len(group),
                "area_m2": facets.area(mesh.points, group),
                "drawn_area_m2": mesh.drawn[name] if mesh.drawn else None,
            }
            for name, group in mesh.surfaces.items()
        }
        return {
            "element_size_m": request.numerics.element_size,
            "elements": len(mesh.cells),
            "kind": checks.kind(mesh.cells).name,
            "nodes": len(mesh.points),
            "shortest_edge_m": float(lengths.min()),
            "longest_edge_m": float(lengths.max()),
            "smallest_scaled_jacobian": float(scaled.min()),
            "warnings": list(mesh.warnings),
            "surfaces": surfaces,
            "mesh": study.relative(path),
            "picture": study.relative(pictures[0]),
            "dark_picture": study.relative(pictures[1]),
        }, [path, *pictures]

    return study.stage("mesh", study.key(__name__, request.key), make)


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
