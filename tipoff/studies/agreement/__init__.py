"""Agreement of the surrogates with the reference, on the conditions of the scene."""

from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.agreement import growth_page, other_rails, page, speed_page, stage

    return Contents(
        (
            Result("agreement", stage.current),
            Result("rails", stored=lambda study: other_rails.beside(study.folder)),
        ),
        (
            Section.of_stage(
                stage.STAGE,
                page.draw,
                "agreement-section",
                "Agreement",
                "Agreement with the reference",
                "compare",
            ),
            Section(
                "growth-section", "Growth of 1 µm", growth_page.draw, "Growth of a 1 µm disturbance"
            ),
            Section("speedup", "Speed", speed_page.draw, "Speed"),
            Section("rails", "Other rails", other_rails.draw, "Other rails"),
        ),
    )


ENTRY = Entry((), _load)
