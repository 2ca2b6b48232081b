# /// script
# [tool.marimo.display]
# theme = "system"
# ///
"""What if the thrust is tilted a little more? A page with sliders that answers at once.

make examples                        # the reference scene
make examples SCENE=my_launcher.toml
"""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="tipoff: what if?")


@app.cell(hide_code=True)
def _():
    import marimo as mo
    from launcher import answer, controls, message
    from launcher.view import EjectionView

    import tipoff

    return EjectionView, answer, controls, message, mo, tipoff


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    # What if?

    Move a slider with the mouse or the arrow keys: tipoff runs the ejection again and plays it.
    """)
    return


@app.cell(hide_code=True)
def _(mo):
    place = mo.ui.text(
        value=mo.cli_args().get("scene") or "reference",
        label="Scene: a name of the catalogue, or the path of your file",
        full_width=True,
    )
    place
    return (place,)


@app.cell(hide_code=True)
def _(answer, mo, place, tipoff):
    def _opened():
        scene = tipoff.load(place.value)
        with mo.status.spinner(
            title=f"Rail compliance of {scene.name}",
            subtitle="found once for a rail and its pads, within a minute or two, and kept",
        ) as progress:
            compliance = answer.compliance(scene)
            progress.update(title="First run", subtitle="its code is compiled once, and kept")
            answer.quick(scene, compliance)
        return scene, compliance

    try:
        scene, compliance = _opened()
    except tipoff.SceneError as error:
        mo.stop(True, mo.callout(mo.plain_text(str(error)), kind="danger"))
    return compliance, scene


@app.cell(hide_code=True)
def _(mo, scene):
    begin = mo.ui.dropdown(
        ["nominal", *scene.conditions], value="nominal", label="Begin at the condition"
    )
    begin
    return (begin,)


@app.cell(hide_code=True)
def _(begin, controls, mo, scene):
    condition = scene.condition(begin.value)
    offered = controls.of_scene(condition)
    sliders = mo.ui.array(
        [
            mo.ui.slider(
                0.0,
                item.high,
                item.step,
                value=start,
                label=item.label,
                show_value=True,
                full_width=True,
            )
            for item, start in offered.items()
        ]
    )
    groups = {}
    for item, slider in zip(offered, sliders):
        groups.setdefault(item.group, []).append(slider.text)
    mo.Html(
        "<div style='display: grid; gap: 10px 20px; "
        "grid-template-columns: repeat(auto-fit, minmax(min(100%, 170px), 1fr))'>"
        + "".join(f"<div><b>{name}</b>{''.join(texts)}</div>" for name, texts in groups.items())
        + "</div>"
    )
    return condition, offered, sliders


@app.cell(hide_code=True)
def _(EjectionView, mo):
    drawing = EjectionView()
    view = mo.ui.anywidget(drawing)
    view
    return drawing, view


@app.cell(hide_code=True)
def _(answer, compliance, condition, controls, drawing, message, mo, offered, sliders, tipoff):
    try:
        changed = condition.replace(
            controls.overrides(condition, dict(zip(offered, sliders.value)))
        )
        quick = answer.quick(changed, compliance)
    except tipoff.SceneError as error:
        mo.stop(True, mo.callout(mo.plain_text(str(error)), kind="danger"))
    drawing.shown = message.made(changed, quick) | {
        "number": drawing.shown.get("number", 0) + 1,
        "is_final": False,
    }
    drawing.latest = changed, compliance
    return


@app.cell(hide_code=True)
def _(answer, drawing, message, mo, view):
    # What takes longer is computed when the sliders rest. This cell reads no slider, so it does not run
    # while they move.
    number = view.value["rested"]
    mo.stop(number == 0 or number != drawing.shown["number"])
    final = answer.run(*drawing.latest)
    drawing.shown = message.made(drawing.latest[0], final) | {"number": number, "is_final": True}
    if final.outcome.rate is not None:
        drawing.error = message.error(final) | {"number": number}
    drawing.latest[0].plot()
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("""
    **How to read it.** The rates are those of the payload in its own axes, means over 2 ms that begin
    1 ms after the last pad has left the rails (grey band). The dashed line is the exit. Pads turn
    orange where they press on a rail. The motion across the rails, the clearance and the errors are
    drawn larger by the factor under the picture; the numbers and curves are not. While a slider
    moves, the rails have no inertia; when it rests, as many of their vibration modes are taken as the
    rates need.

    **How far to trust it.** This is the surrogate with the static compliance of the rails.
    `tipoff compare` measures its error against finite elements, and an ensemble says what rates to
    expect when errors are random: see the tutorials.
    """)
    return


if __name__ == "__main__":
    app.run()
