"""The sentences of docs/verification_and_validation.md that no file of results holds."""

HEAD = """# Verification and validation

Written by `python -m tests.verification`. `tests/verification/test_page.py` checks that the page fits the cases, the
tests, the recorded comparisons and the measurements.

Verification asks whether the equations are solved correctly. {cases} cases have an answer that does not come from this
project (`tests/CASES.md`); {controlled} of them name a control, a weaker method or a slip that the
same test must see fail. Validation asks whether the equations describe the world. Five published measurements are
below. `docs/measured_launches.md` compares a measured launch.

How to read the tables of cases:

- A test may make many comparisons, at several step sizes and meshes. The row shows the one that is nearest to its
  tolerance. Units are SI unless the case says otherwise.
- *error / tolerance* is |ours - answer| over what the test allows; 1 would fail. `error` stands where the test compares
  an error with a bound. `yes or no` stands where a test compares no numbers, such as equal bits or a refusal.
- *order* is the observed order on the finest meshes or steps, where a test measures it.
- *comparisons* says how many were recorded. Slow tests are not recorded.

{tests} tests recorded {comparisons} comparisons. Those of a closed form with its tabulated value are not counted."""

MEASURED = """## Measurements

`tests/measurements` has the numbers and computes ours again. *Read* says which text the numbers come from; no figure
was read off a plot by this project. *Within* is a judgement of ours about what is useful, not an uncertainty of the
measurement, unless the text says so."""

TAIL = """## What is not validated

- A whole ejection along rails: velocity, rates, pad forces. The logs that come with `tipoff measured` are simulated.
- Restitution and damping of pads on rails. Compliant contact and the finite elements lose no energy in contact but by
  friction.
- Friction of anodised 7075. The coefficient moves the settled rates (I1 above).
- Friction of impacts that hardly slip: below about 30 deg from the normal ours differs from M2 by up to 20 % in
  tangential restitution and 30 % in spin. The two-step law, which both models have, has no tangential compliance.
- The interface stiffness of anodised surfaces, and that of bolted mounts. Studies vary both between a quarter and four
  times.
- Joints that open, slip or stiffen; plastic indentation; wear; adhesion and cold welding; rails that bend so far that
  their tension matters. None is modelled.
- Conditions that 1 um of clearance changes much: single curves cannot be compared there, only distributions
  (`docs/chaotic_conditions.md`).

## How to make this page

    python -m tests.verification                     # after a change of cases, controls or measurements
    python -m tests.verification tests/lowfi         # runs the tests of cases in a folder and records them first
    python -m tests.verification --first tests       # each with its first parameters alone"""
