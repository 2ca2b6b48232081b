"""Formulas as MathML, which browsers show by themselves: the site needs no network to be read.

The converter is that of docutils. Raises docutils' MathError for a formula that it does not know.
"""

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml


def visit_inline(writer, node) -> None:
    """A formula in a sentence."""
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def visit_block(writer, node) -> None:
    """A formula set apart."""
    writer.body.append(
        f'<div class="math" style="margin: 0.8em 0">{tex2mathml(node.astext(), as_block=True)}</div>'
    )
    raise nodes.SkipNode


def setup(app) -> dict:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
