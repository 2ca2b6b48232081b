"""Settings of the documentation site: ``make docs`` builds it with warnings as errors."""

import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from docs.pages import command_line, scene_keys  # noqa: E402

project = "tipoff"
author = "tipoff contributors"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "docs.pages.formulas",
    "sphinx_copybutton",
]
exclude_patterns = ["_build"]
smartquotes = False  # they make dashes of the two hyphens before an option
html_theme = "furo"
html_math_renderer = "mathml"
html_title = f"tipoff {release}"
html_static_path = ["_static"]
html_css_files = ["wide.css", "drawing.css"]
html_show_copyright = False

myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
copybutton_prompt_text = "$ "

napoleon_numpy_docstring = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "separated"

_ELSEWHERE = ("index", "glossary")  # pages of this folder with a place of their own


def _further() -> str:
    """The other pages of this folder, one a line: explanations of one thing each."""
    found = sorted(path.stem for path in Path(__file__).parent.glob("*.md"))
    return "\n".join(f"/{name}" for name in found if name not in _ELSEWHERE)


# What a page takes from the code, by the comment that stands in its place.
_MADE = {
    "<!-- every command -->": command_line.markdown,
    "<!-- further explanations -->": _further,
}


def _fill(app, name: str, content: list[str]) -> None:
    """Put the made parts into the source of a page."""
    for place, make in _MADE.items():
        if place in content[0]:
            content[0] = content[0].replace(place, make())
    if name == "reference/scene":
        content[0] = scene_keys.placed(content[0], scene_keys.markdown())


def setup(app) -> None:
    """Called by Sphinx."""
    app.connect("source-read", _fill)
