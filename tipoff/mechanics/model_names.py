"""Names of the models of an ejection, used in options, arguments and result files.

* ``compliant``: rigid bodies; pads press on the rail's static compliance, condensed from the finite
  elements. The default.
* ``springs``: rigid bodies; one spring and damper at each pad face, with the scene's constants or
  calibrated ones.
* ``finite-elements``: the reference, with flexible rails.
"""

COMPLIANT, SPRINGS, FINITE_ELEMENTS = "compliant", "springs", "finite-elements"
SURROGATES = (COMPLIANT, SPRINGS)
MODELS = (*SURROGATES, FINITE_ELEMENTS)
