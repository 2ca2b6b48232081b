"""The colours of figures, light and dark: the page sets them by CSS, so that charts follow the colour
scheme of the reader and are light on paper.

A figure is drawn with its light colours. On the page each is a custom property of CSS, with another
value in a dark scheme. Colours differ in lightness, so that figures read in grey.
"""

import re

NAVY, VERMILION, AMBER, TEAL, GREY = "#1d3461", "#d1495b", "#e8a33d", "#2e8b7a", "#7a7f87"
AXIS_COLOURS = {"x": NAVY, "y": VERMILION, "z": AMBER}
INK, RULE, EDGE, ZERO = "#24292f", "#e3e6ea", "#9aa1a9", "#c9ced4"
DARK = {  # the colour of each light one on a dark page
    NAVY: "#8fb4f0",
    VERMILION: "#f27d8c",
    AMBER: "#f0b762",
    TEAL: "#5fc7b4",
    GREY: "#9aa2ac",
    "#7b4b94": "#c096d6",
    "#8c6d46": "#c9a877",
    "#b0b5bb": "#848c96",
    "#5f9ed1": "#83bbe8",
    "#c98bb9": "#dca8cd",
    "#d5dae0": "#4a545f",
    "#dfe3e8": "#cdd3da",
    INK: "#e6e8eb",
    RULE: "#2f3842",
    EDGE: "#6d7782",
    ZERO: "#4a545f",
    "#444444": "#6d7782",  # ticks of plotly
    "#b0b0b0": "#3d4752",  # grid of matplotlib
    "#000000": "#e6e8eb",
    "#ffffff": "#13181e",
}


def css() -> str:
    """The properties, light and dark, and the rules that give them to the charts of plotly."""
    light = "".join(f"{_property(colour)}: {colour}; " for colour in DARK)
    dark = "".join(f"{_property(colour)}: {other}; " for colour, other in DARK.items())
    rules = "".join(
        f'.js-plotly-plot [style*="{kind}: {_rgb(colour)}"] '
        f"{{ {kind}: var({_property(colour)}) !important; }}\n"
        for colour in DARK
        for kind in ("stroke", "fill")
    )
    return (
        f":root {{ {light}}}\n"
        f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark}}} }}\n"
        f"{rules}.js-plotly-plot .main-svg {{ background: none !important; }}\n"
    )


def themed(svg: str, name: str) -> str:
    """An SVG of matplotlib as part of the page: its colours are the properties, its text without a
    colour is that of the page, and its ids begin with ``name``."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(
        r"#[0-9a-f]{6}\b",
        lambda found: f"var({_property(found[0])})" if found[0] in DARK else found[0],
        body,
    )
    body = re.sub(r'( id="|url\(#|href="#)', rf"\g<1>{name}-", body)
    return body.replace("<svg", f'<svg class="picture" role="img" aria-label="{name}"', 1)


def _property(colour: str) -> str:
    return f"--c{colour[1:]}"


def _rgb(colour: str) -> str:
    """A colour as browsers write it in a style."""
    return f"rgb({', '.join(str(int(colour[i : i + 2], 16)) for i in (1, 3, 5))})"
