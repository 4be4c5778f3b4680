"""Sphinx builds the site from the pages that tools/make_site.py has put into build/docs/source."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]

project = "dartcast"
copyright = "the authors of dartcast"
version = re.search(r"VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
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
