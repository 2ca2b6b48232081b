"""Show stress and motion of one condition; writes view/CONDITION/ with run.pvd, and pictures
where pyvista is installed.

Open run.pvd in ParaView. It shows undeformed rails and the payload in axes of the platform. To
see the deformation of the rails, use "Warp By Vector" with the array "displacement (m)" and a
scale factor of some hundreds. Colour by "von Mises stress (Pa)" or "contact pressure (Pa)".

  tipoff view --condition phi60 --frames 120
  tipoff view --scene my_launcher.toml --set studies.element_size="4 mm"

Pictures (peak.png, ejection.webp, and both for a dark page) need pyvista: pip install pyvista.
The files for ParaView do not need it.
"""

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result
from tipoff.studies.view.options import Options


def _answer(request: Request, options: Options) -> Output:
    from tipoff.studies.view import page, stage

    found = stage.run(request.study(), options)
    return Output.of(found, lambda found: page.terminal(found, request.out))


def _load() -> Contents:
    from tipoff.studies.view import stage

    return Contents((Result("view", stored=stage.stored),))


ENTRY = Entry((command("view", __doc__, Options, _answer, ["workers"]),), _load)
