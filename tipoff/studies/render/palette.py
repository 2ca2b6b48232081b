"""The colours of figures, light and dark. The page sets them by CSS, so charts have the colour scheme of
the reader, and are light on paper.

A figure is drawn with light colours. On the page each colour is a custom property of CSS, with another
value in a dark scheme. Colours differ in lightness, so figures are clear in grey.
"""

import re
from html import escape

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
    "#b0b0b0": "#3d4752",  # grid
    "#000000": "#e6e8eb",
    "#ffffff": "#13181e",
}


def css() -> str:
    """The properties, light and dark."""
    light = "".join(f"{_property(colour)}: {colour}; " for colour in DARK)
    dark = "".join(f"{_property(colour)}: {other}; " for colour, other in DARK.items())
    return (
        f":root {{ {light}}}\n"
        f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark}}} }}\n"
    )


def themed(svg: str, name: str, words: str) -> str:
    """An SVG of matplotlib as part of the page. Its colours are the properties, and text without a
    colour has the colour of the page. Its id is ``name``, and all ids in it begin with ``name``.
    ``words`` describe it for a reader who does not see it."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(
        r"#[0-9a-f]{6}\b",
        lambda found: f"var({_property(found[0])})" if found[0] in DARK else found[0],
        body,
    )
    body = re.sub(r'( id="|url\(#|href="#)', rf"\g<1>{name}-", body)
    label = escape(words, quote=True)
    return body.replace(
        "<svg", f'<svg class="picture" id="{name}" role="img" aria-label="{label}"', 1
    )


def _property(colour: str) -> str:
    return f"--c{colour[1:]}"
