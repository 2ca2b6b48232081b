"""Evidence about tipoff, outside the package: the same cases in other codes, speeds and their growth, the
paper's random errors, the search for the inputs that the paper does not print, and the recovery of
hidden values.

`python -m validation` is `tipoff` with these studies. They have sections of their own on the page.
"""

from validation import bench, montecarlo, paper, peers, recovery, scaling

STUDIES = (
    montecarlo.ENTRY,
    paper.QUESTION,
    recovery.QUESTION,
    scaling.QUESTION,
    bench.ENTRY,
    peers.ENTRY,
)
