"""Runs of all conditions in both models."""

from tipoff.studies.question import Contents, Entry, Result, Section


def _load() -> Contents:
    from tipoff.studies.runs import page, stage, stress_page

    return Contents(
        (
            Result("highfi", lambda study: stage.run(study, "highfi")),
            Result("lowfi", lambda study: stage.run(study, "lowfi")),
        ),
        (
            Section("thrust", "Thrust", page.thrust, "Thrust"),
            Section("figure6", "Curves", page.curves, "Velocity and rates"),
            Section("contact-forces", "Contact", page.contact, "Contact forces"),
            Section("energy", "Energy", page.energy, "Energy ledgers"),
            Section("stress", "Stress", stress_page.draw, "Stress of the rails"),
        ),
    )


ENTRY = Entry((), _load)
