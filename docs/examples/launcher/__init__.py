"""Parts of the page ``what_if.py``: what its sliders change, what is computed, what is sent to the
browser, and the view that draws it.

A slider changes a few keys of the scene (``controls``), the surrogate runs (``answer``), and one
message of some 30 kB goes to the page (``message``), where ``view`` plays it without asking again.
"""
