"""Show stress and motion of one condition, or the mesh of the rails; writes view/CONDITION/ with run.pvd,
and pictures where pyvista is installed.

Open run.pvd in ParaView. It shows undeformed rails and the payload in axes of the platform. To
see the deformation of the rails, use "Warp By Vector" with the array "displacement (m)" and a
scale factor of some hundreds. Colour by "von Mises stress (Pa)" or "contact pressure (Pa)".

  tipoff view --condition phi60 --frames 120
  tipoff view --scene my_launcher.toml --set studies.element_size="4 mm"
  tipoff view --scene my_launcher.toml --mesh

Pictures (peak.png, ejection.webp, and both for a dark page) need pyvista: pip install pyvista.
The files for ParaView do not need it.

--mesh needs no run. It writes mesh.json (size, surfaces, quality), mesh.vtu, and rail.inp: the first rail
for CalculiX and Abaqus, with a load and the answers of tipoff in its head (ccx rail).
"""

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result
from tipoff.studies.view.options import ViewCommand


def _answer(request: Request, asked: ViewCommand) -> Output:
    study = request.study()
    if asked.mesh:
        asked.require_mesh()
        from tipoff.studies.mesh import page as meshed
        from tipoff.studies.mesh import stage as mesh

        return Output.of(mesh.run(study), meshed.draw, request.out)
    from tipoff.studies.view import page, stage

    return Output.of(
        stage.run(study, asked.options), lambda found: page.draw(found, study.folder), request.out
    )


def _load() -> Contents:
    from tipoff.studies.view import stage

    return Contents((Result("view", stored=stage.stored),))


ENTRY = Entry((command("view", __doc__ or "", ViewCommand, _answer, ["workers"]),), _load)
