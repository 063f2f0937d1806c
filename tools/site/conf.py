"""The site of the documentation, for Sphinx: ``make site``.

The pages stay Markdown without a generator's signs, as one reads them in the repository. What a site needs
besides is made here: the navigation from README's table, the changelog from its fragments.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

TOOLS = Path(__file__).parents[1]
sys.path.insert(0, str(TOOLS))

from sphinx import addnodes  # noqa: E402
from sphinx.application import Sphinx  # noqa: E402
from sphinx.transforms.post_transforms import SphinxPostTransform  # noqa: E402

import pages  # noqa: E402

project = html_title = "Mutabot"
copyright = "the authors of Mutabot"
extensions = ["myst_parser", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
root_doc = Path(pages.HOME).stem
include_patterns = pages.pages()
exclude_patterns = ["**/.*", "site", "src", "tests", "build", "dist"]

# anchors are those of GitHub
myst_heading_anchors = 6
highlight_language = "text"

html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["style.css"]
html_js_files = ["reach.js"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5c8a", "color-brand-content": "#0b5c8a"},
    "dark_css_variables": {"color-brand-primary": "#6cc1f0", "color-brand-content": "#6cc1f0"},
}
copybutton_exclude = ".linenos, .gp, .go"

_CHANGELOG = "CHANGELOG"
#: kind of a fragment -> the heading it stands under
_KINDS = {"feature": "New", "change": "Changed", "bugfix": "Mended"}


def navigation() -> str:
    """The groups of pages, as Sphinx asks for them."""
    lines = []
    for group, entries in pages.navigation().items():
        lines += ["", "```{toctree}", ":hidden:", f":caption: {group}", ""]
        lines += [f"{title} <{path}>" for title, path in entries]
        lines += ["```"]
    return "\n".join([*lines, ""])


def unreleased() -> str:
    """The changelog's fragments, by kind, the latest issue first."""
    found: dict[str, list[tuple[int, str, Path]]] = {kind: [] for kind in _KINDS}
    for path in (pages.ROOT / "changelog").glob("*.*.md"):
        issue, *_, kind = path.stem.split(".")
        found[kind].append((-int(issue), path.stem, path))
    lines = ["", "## Unreleased"]
    for kind, heading in _KINDS.items():
        lines += ["", f"### {heading}", ""]
        for _, _, path in sorted(found[kind]):
            # links of a fragment lead from its own folder, those of the changelog from the one above
            text = path.read_text(encoding="utf-8").strip().replace("](../", "](")
            lines += ["- " + text.replace("\n", "\n  ")]
    return "\n".join([*lines, ""])


def add_what_a_site_needs(app: Sphinx, docname: str, source: list[str]) -> None:
    """Navigation to the home page, fragments to the changelog."""
    if docname == root_doc:
        source[0] += navigation()
    elif docname == _CHANGELOG:
        source[0] += unreleased()


class Folders(SphinxPostTransform):
    """A link to a folder, which the repository's web view shows with its README, leads to that README."""

    default_priority = 8  # before MyST looks for what its links mean

    def run(self, **_: Any) -> None:
        for node in list(self.document.findall(addnodes.pending_xref)):
            if node["reftype"] != "myst" or node["refdomain"] == "doc":
                continue
            path, _anchor = pages.leads_to(f"{node['refdoc']}.md", node["reftarget"])
            if f"{path}/README" in self.env.all_docs:
                node["refdomain"], node["reftarget"] = "doc", f"{path}/README"
                node["reftargetid"] = None


def make_index(app: Sphinx, exception: Exception | None) -> None:
    """The home page under the name that browsers ask for."""
    if exception is None and app.builder.format == "html":
        shutil.copyfile(Path(app.outdir, f"{root_doc}.html"), Path(app.outdir, "index.html"))


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("source-read", add_what_a_site_needs)
    app.connect("build-finished", make_index)
    app.add_post_transform(Folders)
