"""Run random errors of thrust and mass as in the paper's Table 3: quantiles of the rates and
probabilities above limits, with bounds; writes montecarlo.json.

The paper has 1,000 cases. Its Table 3 can be read in several ways; all readings are compared. --vary has
the errors of a file instead.
Both surrogates run the same cases. With --reference the first cases also run in the finite
elements. They correct rates, quantiles and probabilities; this writes tails.json.

  python -m validation montecarlo --cases 1000000 --limit "x=2 deg/s" --limit "8 deg/s"
  python -m validation montecarlo --reading half --angles shared --initial
  python -m validation montecarlo --reference 200
"""

from typing import TYPE_CHECKING

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.populations.reading import Reading
from tipoff.studies.question import Contents, Entry, Result, Section
from validation.montecarlo.options import Cases, MontecarloOptions

if TYPE_CHECKING:
    from tipoff.studies.render.document import Part
    from tipoff.studies.report.page import Page

_DRAWS = 60  # of the reference, by the report


def _answer(request: Request, options: MontecarloOptions) -> Output:
    from validation.montecarlo import page, stage, tails, tails_page

    _require(options)
    study = request.study()
    if options.draws is None:
        return Output.of(stage.run(study, options.population), page.summary, request.out)
    tails.checked(study, options)
    found, checked = stage.run(study, options.population), tails.run(study, options)
    parts = [*page.summary(found.result), *tails_page.summary(checked.result)]
    document = {**found.document, "reference": checked.document}
    return Output(document, lambda _: parts, request.out)


def _require(options: MontecarloOptions) -> None:
    """Raise SceneError for options that would have no effect, every fault listed."""
    from tipoff.faults import Fault, SceneError
    from tipoff.mechanics.model_names import SPRINGS

    faults = []
    if options.draws is None and options.fine is not None:
        faults.append(Fault("--finer", "option", str(options.fine), "--reference for this option"))
    if options.population.reading.interface and options.population.model == SPRINGS:
        expected = "none with --model springs, which have no interface stiffness"
        faults.append(Fault("--interface", "option", "yes", expected))
    vary = options.population.vary
    if vary is not None and options.population.reading != Reading():
        expected = "no option of a reading, since the file has the distributions"
        faults.append(Fault("--vary", "option", vary, expected))
    if faults:
        raise SceneError(faults)


def _load() -> Contents:
    from validation.montecarlo import page, stage, tails, tails_page

    def errors(shown: "Page") -> "list[Part]":
        return shown.shown(stage.STAGE, page.draw, stage.NAME)

    def corrected(shown: "Page") -> "list[Part]":
        return shown.shown(tails.STAGE, tails_page.draw, f"{stage.NAME} --reference {_DRAWS}")

    return Contents(
        (
            Result(
                stage.NAME,
                stage.run,
                stage.STAGE.stored,
                lambda study, limits: stage.run(study, Cases(limits=limits)),
            ),
            Result(
                tails.NAME,
                lambda study: tails.run(study, MontecarloOptions(draws=_DRAWS)),
                tails.STAGE.stored,
            ),
        ),
        (
            Section(stage.NAME, "Random errors", errors, "Random errors"),
            Section(tails.NAME, "Tails", corrected, "Random errors checked by the reference"),
        ),
    )


ENTRY = Entry((command("montecarlo", __doc__ or "", MontecarloOptions, _answer),), _load)
