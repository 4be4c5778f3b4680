"""Sphinx builds the site from the pages that tools/make_site.py has put into build/docs/source."""
import gc
import itertools
import logging
import pathlib
import re

from sphinx.domains.cpp import ASTDeclaration

ROOT = pathlib.Path(__file__).resolve().parents[3]

project = "dartcast"
copyright = "the authors of dartcast"
version = re.search(r"project\(\w+ VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
release = version
html_title = f"dartcast {version}"

extensions = ["breathe", "myst_parser", "sphinx_copybutton"]
breathe_projects = {"dartcast": str(ROOT / "build" / "docs" / "doxygen" / "xml")}
breathe_default_project = "dartcast"
breathe_default_members = ("members",)
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages begin at any level
primary_domain = "cpp"
highlight_language = "text"

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_use_index = False  # the search finds all names
html_domain_indices = False


# Pages of the C++ reference are large trees, which the collector would go through again and again: two thirds of the time.
gc.disable()
pages_written = itertools.count()

# Sphinx 5 computes the names of all declarations of a namespace for each word that may be a link: remember them.
newest_id = ASTDeclaration.get_newest_id


def remembered_id(declaration: ASTDeclaration) -> str:
    if not hasattr(declaration, "remembered_id"):
        declaration.remembered_id = newest_id(declaration)
    return declaration.remembered_id


ASTDeclaration.get_newest_id = remembered_id


def collect(*_: object) -> None:
    if next(pages_written) % 40 == 0:
        gc.collect()


def setup(app: object) -> None:
    """The page of each part declares the namespace, which Sphinx takes for a duplicate."""
    logger = logging.getLogger("sphinx.sphinx.domains.cpp")
    logger.addFilter(lambda record: not record.getMessage().endswith("'.. cpp:type:: dartcast'."))
    app.connect("doctree-resolved", collect)
