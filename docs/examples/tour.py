# /// script
# [tool.marimo.display]
# theme = "system"
# ///
"""A tour of tipoff in Python: a scene, a run, its curves, an ensemble, and what limits the trust.

.venv/bin/marimo edit docs/examples/tour.py      # read, change, run
python docs/examples/tour.py --count 64          # as a script, also with --scene my_launcher.toml
"""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="tipoff: a tour")


@app.cell
def _():
    import marimo as mo
    import numpy as np

    import tipoff

    name = mo.cli_args().get("scene") or "reference"
    count = int(mo.cli_args().get("count") or 1000)
    return count, mo, name, np, tipoff


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    # A tour of tipoff

    A thruster pushes a payload along four rails. Pads on the payload slide in the rails with a
    clearance of a quarter of a millimetre. The thrust is never quite straight, so the payload
    strikes the rails and leaves them with angular rates. tipoff predicts these rates.

    ## 1. A scene

    A scene is all that a run needs: bodies, pads, rails, thrust, contact, friction. It comes from the
    catalogue by name, or from your TOML file by path. Values are in SI units and radians.
    """)
    return


@app.cell
def _(name, tipoff):
    scene = tipoff.load(name)
    print(scene)
    print(f"{scene.payload.mass} kg, {scene.thrust.peak} N, clearance {scene.contact.clearance} m")
    print("effects it does without:", ", ".join(scene.absent_effects()))
    return (scene,)


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    ## 2. A run

    The first run finds the compliance of the rails from finite elements. That takes a minute or two and
    is kept. Every later run takes milliseconds.
    """)
    return


@app.cell
def _(scene, tipoff):
    compliance = tipoff.compliance(scene)
    run = tipoff.run(scene.condition("phi15"), compliance=compliance)
    print(run.summary())
    return compliance, run


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    The settled rate is a mean over 2 ms, which begin 1 ms after the last pad has left the rails. x runs
    along the rails; a rate about y or z tilts the payload off its course.

    ## 3. Curves

    A run has the whole motion, with the same names and units in every model. A jump of a rate is an
    impact of a pad.
    """)
    return


@app.cell
def _(np, run):
    pressed = np.linalg.norm(run.pad_force, axis=2)  # N, samples by faces of pads
    first = run.time[(pressed > 0.0).any(axis=1)][0]
    print(f"first contact {1e3 * first:.1f} ms, largest force on a face {pressed.max():.0f} N")
    run.plot()
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    ## 4. What if?

    `replace` changes values by their keys. Text has a unit, a bare number is SI, and `"absent"` in place
    of a table, such as `friction`, removes an effect.
    """)
    return


@app.cell
def _(compliance, np, scene, tipoff):
    phi15 = scene.condition("phi15")
    changes = {
        "as it is": {},
        "three times the misalignment": {"thrust_offset.misalignment.axial": "0.3 deg"},
        "half the clearance": {"contact.clearance": "0.125 mm"},
        "half the friction": {"friction.static": 0.1, "friction.dynamic": 0.1},
    }
    for words, change in changes.items():
        changed = tipoff.run(phi15.replace(change), compliance=compliance, sensitivity=False)
        print(f"{words:30}", np.degrees(changed.outcome.rate).round(2), "deg/s")
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    ## 5. An ensemble

    Nobody knows the errors of a launcher that is not built yet. An ensemble draws them from
    distributions, here those of the paper that the reference scene follows, and gives the distribution
    of the rates.
    """)
    return


@app.cell
def _(compliance, count, np, scene, tipoff):
    cases = tipoff.ensemble(scene, "paper", compliance=compliance, count=count)
    rates = np.degrees(np.linalg.norm(cases.rate, axis=1))
    print(f"{int((cases.status == 'exited').sum())} of {count} payloads left the rails")
    for share in (0.5, 0.9, 0.99):
        print(
            f"{share:.0%} of the payloads turn slower than {np.nanquantile(rates, share):.1f} deg/s"
        )
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    ## 6. How far to trust it

    Three things limit what a single run says. The balances of energy and momentum show whether the
    equations were solved. Every run has further runs, with 1 µm more and less clearance, which show
    whether the ejection is chaotic: if it changes a rate by more than 0.1 deg/s, only an ensemble is useful. And the
    surrogate itself differs from finite elements; `tipoff compare` measures by how much.
    """)
    return


@app.cell
def _(compliance, scene, tipoff):
    tighter = scene.replace({"contact.clearance": "0.05 mm", "thrust.peak": "10 kN"})
    for title, looked_at in (("as it is", scene), ("tighter and stronger", tighter)):
        moved = tipoff.run(looked_at, compliance=compliance).checks
        by_clearance = moved.get("rate_change_by_clearance_deg_s")  # none if a run does not settle
        said = "leaves no settled rates" if by_clearance is None else f"{by_clearance:.2g} deg/s"
        print(f"{title:22} change of a rate by 1 µm of clearance: {said}")
    return


@app.cell
def _(run):
    for balance, error in run.checks.items():
        print(f"{balance:40} {error:.1e}")
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    ## Next

    - `make examples` opens a page with sliders.
    - The tutorials go on: your launcher, the surrogate against finite elements, tolerances.
    """)
    return


if __name__ == "__main__":
    app.run()
