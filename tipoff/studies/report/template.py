"""The HTML frame of the page: head, navigation, sections."""

from collections.abc import Sequence
from typing import NamedTuple

from jinja2 import Environment
from markupsafe import Markup

from tipoff.studies.render.style import CSS


class Drawn(NamedTuple):
    """A section as HTML: its ``anchor``, the text of the ``link`` to it, its ``html``."""

    anchor: str
    link: str
    html: str


class Group(NamedTuple):
    """Sections under one ``title``; ``end`` is a paragraph of HTML below them."""

    title: str
    sections: Sequence[Drawn]
    end: str = ""


_ENVIRONMENT = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
_PAGE = _ENVIRONMENT.from_string(
    """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{{ title }}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>{{ style }}</style>
</head>
<body>
<header>
<h1>{{ title }}</h1>
<p class="lead">{{ lead }}</p>
</header>
<nav aria-label="Contents">
{% for group in groups %}
<span>{% if group.title %}<b>{{ group.title }}</b>{% endif %}

{% for section in group.sections %}
<a href="#{{ section.anchor }}">{{ section.link }}</a>
{% endfor %}
</span>
{% endfor %}
</nav>
<main>
{% for group in groups %}
{% if group.title %}<h2 class="part">{{ group.title }}</h2>{% endif %}

{% for section in group.sections %}
{{ section.html | safe }}
{% endfor %}
{{ group.end | safe }}
{% endfor %}
</main>
</body>
</html>
"""
)
_SECTION = _ENVIRONMENT.from_string(
    '<section id="{{ anchor }}"><h2>{{ title }}</h2>{{ body | safe }}</section>'
)


def page(title: str, lead: str, groups: Sequence[Group]) -> str:
    """The whole page; ``lead`` is the line below the title."""
    return _PAGE.render(title=title, lead=lead, style=Markup(CSS), groups=groups)


def section(anchor: str, title: str, body: str) -> Markup:
    """A section with its heading; ``body`` is HTML."""
    return Markup(_SECTION.render(anchor=anchor, title=title, body=body))
