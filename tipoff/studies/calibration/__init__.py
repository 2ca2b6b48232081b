"""Contact of the surrogate from the finite elements: rail compliance, constants fitted to curves."""

from tipoff.studies.calibration import command
from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.calibration import compliance, compliance_page, page, stage

    return Contents(
        (
            Result("compliance", compliance.run),
            Result("calibration", stage.run),
        ),
        (
            Section.of_stage(
                compliance.STAGE,
                compliance_page.draw,
                "compliance",
                "Compliance",
                "Rail compliance",
                "calibrate",
            ),
            Section.of_stage(
                stage.STAGE, page.draw, "calibration", "Calibration", "Calibration", "calibrate"
            ),
        ),
    )


ENTRY = Entry((command.calibrate,), _load)
