"""Evidence about tipoff, outside the package: the same cases in other codes, speeds and their growth, the
paper's random errors, the search for the inputs that the paper does not print, the recovery of hidden values,
the ripple of a contact force, hard cases with the methods that fail on them, and measured launches of rockets.

`python -m validation` is `tipoff` with these studies. They have sections of their own on the page, but for the
launches, whose page is docs/measured_launches.md.
"""

from validation import (
    bench,
    flights,
    montecarlo,
    paper,
    peers,
    recovery,
    ripple,
    scaling,
    stability,
)

STUDIES = (
    montecarlo.ENTRY,
    paper.QUESTION,
    recovery.QUESTION,
    ripple.QUESTION,
    scaling.QUESTION,
    stability.QUESTION,
    bench.ENTRY,
    peers.ENTRY,
    flights.ENTRY,
)
