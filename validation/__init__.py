"""Evidence about tipoff, outside the package: the same cases in other codes, speeds, the search for the
inputs that the paper does not print, and the recovery of hidden values.

`python -m validation` is `tipoff` with these studies. They have sections of their own on the page.
"""

from validation import bench, paper, peers, recovery

STUDIES = (paper.QUESTION, recovery.QUESTION, bench.ENTRY, peers.ENTRY)
