"""Compare the surrogates with the reference on fitted and held-out conditions: agreement, floor,
speed-up; writes agreement.json.

tipoff curves compares files of other codes.
"""

from tipoff.studies.agreement.options import Options
from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.question import Contents, Entry, Result, Section


def _answer(request: Request, options: Options) -> Output:
    from tipoff.studies.agreement import page, stage

    found = stage.run(request.study(), options)
    return Output(found, lambda found: page.terminal(stage.STAGE.read(found)), request.out)


def _load() -> Contents:
    from tipoff.studies.agreement import growth_page, other_rails, page, speed_page, stage

    return Contents(
        (
            Result("agreement", stage.current),
            Result("rails", stored=lambda study: other_rails.beside(study.folder)),
        ),
        (
            Section("agreement-section", "Agreement", page.draw, "Agreement with the reference"),
            Section(
                "growth-section", "Growth of 1 µm", growth_page.draw, "Growth of a 1 µm disturbance"
            ),
            Section("speedup", "Speed", speed_page.draw, "Speed"),
            Section("rails", "Other rails", other_rails.draw, "Other rails"),
        ),
    )


ENTRY = Entry((command("compare", __doc__ or "", Options, _answer),), _load)
