"""Links of the pages lead somewhere, and the site has every page once."""

from __future__ import annotations

import re
from collections import Counter

import pytest

import pages

PAGES = pages.pages()
#: a link with a scheme leads out of the repository; whether anybody is there is not ours to say
_SCHEME = re.compile(r"[a-z]+:")


def text_of(page: str) -> str:
    return (pages.ROOT / page).read_text(encoding="utf-8")


def relative_targets(page: str) -> list[str]:
    text = text_of(page)
    return [target for target in pages.links(text) + pages.pictures(text) if not _SCHEME.match(target)]


def fault(page: str, target: str) -> str:
    """What is wrong with a relative link; empty if nothing is."""
    path, anchor = pages.leads_to(page, target)
    place = pages.ROOT / path
    if path.startswith("..") or not place.exists():
        return f"there is no {path}"
    if place.is_dir() and f"{path}/README.md" not in PAGES:
        return f"{path} is a folder without a README, so the site has no page for it"
    if place.suffix == ".md" and path not in PAGES:
        return f"{path} is no page of the site"
    if anchor and (place.suffix != ".md" or anchor not in pages.anchors(text_of(path))):
        return f"{path} has no heading {anchor!r}"
    return ""


def test_every_link_leads_somewhere() -> None:
    faults = {(page, target): fault(page, target) for page in PAGES for target in relative_targets(page)}
    assert len(faults) > 100
    assert {where: what for where, what in faults.items() if what} == {}


@pytest.mark.parametrize(
    ("target", "told"),
    [
        ("tutoriel.md", "there is no docs/tutoriel.md"),
        ("../../elsewhere.md", "there is no ../elsewhere.md"),
        ("verdicts.md#survivers", "docs/verdicts.md has no heading 'survivers'"),
        ("../benchmarks", "benchmarks is a folder without a README, so the site has no page for it"),
        ("../tests/suites/README.md", "tests/suites/README.md is no page of the site"),
        ("img/cell.png#left", "docs/img/cell.png has no heading 'left'"),
    ],
)
def test_a_link_that_leads_nowhere_is_seen(target: str, told: str) -> None:
    assert fault("docs/limits.md", target) == told


@pytest.mark.parametrize("target", ["verdicts.md#survivors", "../CONTRIBUTING.md", "../examples/paper"])
def test_a_link_that_leads_somewhere_has_no_fault(target: str) -> None:
    assert fault("docs/limits.md", target) == ""


def test_links_of_both_kinds_are_looked_at() -> None:
    targets = [target for page in PAGES for target in relative_targets(page)]
    assert len(targets) > 250
    assert sum("#" in target for target in targets) > 100


@pytest.mark.parametrize(
    ("heading", "anchor"),
    [
        ("# And now?", "and-now"),
        ("## `oracle_nodes`", "oracle_nodes"),
        (
            "## When `mutabot run` is called again?",
            "when-mutabot-run-is-called-again",
        ),
        ("## A *second* [look](x.md)", "a-second-look"),
        ("## Prüfung – by-to", "prüfung--by-to"),
    ],
)
def test_an_anchor_is_the_heading_without_signs(heading: str, anchor: str) -> None:
    assert pages.anchors(heading) == [anchor]


def test_equal_headings_are_numbered() -> None:
    assert pages.anchors("# A\n\n## B\n\n```\n# B\n```\n\n## B\n") == ["a", "b", "b-1"]


def test_the_navigation_has_every_page_but_the_home_once() -> None:
    listed = Counter(path for entries in pages.navigation().values() for _, path in entries)
    assert listed == Counter(page for page in PAGES if page != pages.HOME)


def test_a_page_begins_with_its_one_title() -> None:
    for page in PAGES:
        levels = [token.tag for token in pages.tokens_of(text_of(page)) if token.type == "heading_open"]
        assert levels[0] == "h1", page
        assert levels.count("h1") == 1, page


def test_the_gallery_has_every_picture_once() -> None:
    pictures = {path.relative_to(pages.ROOT).as_posix() for path in (pages.ROOT / "docs" / "img").iterdir()}
    gallery = "docs/gallery.md"
    shown = [pages.leads_to(gallery, target)[0] for target in pages.pictures(text_of(gallery))]
    assert sorted(shown) == sorted(pictures)
