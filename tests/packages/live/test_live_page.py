"""The page of a running campaign in headless Chromium: it fills, and the reader stays where he is."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mutabot.journal.journal import Journal
from mutabot.journal.records import BaselineTest, ControlEnd
from mutabot.model.events import TestEnd
from mutabot_live.pages import Pages
from mutabot_live.server import LiveFeed, Server
from results import samples

sync_api = pytest.importorskip("playwright.sync_api", reason="requirements-reports.lock is not installed")

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [pytest.mark.whole, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed")]


@pytest.fixture
def page() -> Iterator[Any]:
    wrong: list[str] = []
    sandbox = [] if os.getuid() else ["--no-sandbox"]
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=sandbox)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.on(
            "console",
            lambda message: wrong.append(message.text) if message.type in ("error", "warning") else None,
        )
        page.on("pageerror", lambda error: wrong.append(str(error)))
        yield page
        browser.close()
    assert wrong == []


def state(version: int, **changes: Any) -> dict[str, Any]:
    usual = {"stage": "mutants", "line": "", "done": version, "total": 10, "left": 30.0}
    return {**usual, "ended": "", "version": version, "every": 0.1, **changes}


def _use_buttons(page: Any) -> None:
    """Stop at the second thought."""
    for answer in ("Let it run", "Stop it"):
        page.get_by_role("button", name="Stop …").click()
        page.get_by_role("button", name=answer).click()
        page.wait_for_selector("dialog", state="detached")


def _wait_for_version(page: Any, version: int) -> None:
    """Until the page has these data; its policy allows no script that polls."""
    drawn = "typeof mutabot === 'object' && mutabot.campaign && mutabot.campaign.version"
    for _ in range(600):
        if page.evaluate(drawn) == version:
            return
        page.wait_for_timeout(50)
    pytest.fail(f"the page never had version {version} of the data")


def test_a_click_during_which_newer_data_come_is_not_lost(page: Any, tmp_path: Path) -> None:
    path = tmp_path / "journal.sqlite"
    version = [1]
    feed, pages = LiveFeed(), Pages(path, "cell", lambda: version[0])
    server = Server(pages, feed, {})
    try:
        with Journal.create(path, meta=samples.meta()) as journal:
            journal.set_plan(samples.MUTANTS, samples.LEFT_OUT, sources={"mission.py": samples.PROGRAM})
            feed.put(state(1))
            page.goto(server.address)
            _wait_for_version(page, 1)

            page.get_by_role("link", name="Mutants", exact=True).hover()
            page.mouse.down()
            version[0] = 2
            feed.put(state(2))
            _wait_for_version(page, 2)
            page.mouse.up()
            page.get_by_label("Search").wait_for()
    finally:
        page.close()
        feed.close()
        server.close()


def test_it_fills_and_says_how_it_ended(page: Any, tmp_path: Path) -> None:
    known = [0]
    given: list[str] = []
    path = tmp_path / "journal.sqlite"
    feed, pages = LiveFeed(), Pages(path, "cell", lambda: known[0])
    names = ("stop",)
    server = Server(pages, feed, {name: lambda name=name: given.append(name) for name in names})  # type: ignore[misc]
    try:
        feed.put(state(0, stage="baseline", total=None, left=None))
        page.goto(server.address)
        page.get_by_text("The tests run on the original first").wait_for()

        with Journal.create(path, meta=samples.meta()) as journal:
            journal.set_plan(samples.MUTANTS, samples.LEFT_OUT, sources={"mission.py": samples.PROGRAM})
            known[0] = 1
            feed.put(state(1))
            page.get_by_text("Nothing is judged yet").wait_for()
            page.get_by_role("link", name="Mutants", exact=True).click()
            search = page.get_by_label("Search")
            search.fill("gripper")
            assert page.locator("table.mutants .m-unrun").count() > 0
            for outcome in samples.OUTCOMES:
                journal.add_outcome(outcome)
            pages.look_at_once()
            known[0] = 2
            feed.put(state(2, line="#1 round 1: killed by check"))
            page.locator("table.mutants tr.is-survivor").wait_for()
            assert search.evaluate("one => [one === document.activeElement, one.value]") == [True, "gripper"]
            told = page.locator("#live").inner_text()
            assert all(words in told for words in ("2 of 10", "s left", "#1 round 1: killed by check"))

            _use_buttons(page)
            journal.finish("interrupted")
        pages.look_at_once()
        known[0] = 3
        feed.note("<b>a note</b>")
        feed.put(state(3, ended="interrupted"))
        page.get_by_text("The campaign has ended: interrupted.").first.wait_for()
        assert page.locator("#live button:visible").count() == 0
        page.get_by_role("link", name="Overview").click()
        page.get_by_text("This campaign is not complete (interrupted)").wait_for()
        page.locator("#live summary").click()
        assert page.locator("#live li").inner_text() == "<b>a note</b>"
        assert given == ["stop"]
    finally:
        page.close()  # a server that ends resets what the browser still listens to
        feed.close()
        server.close()


def test_before_the_first_verdict_nothing_is_said_of_tests_readings_and_controls(
    page: Any, tmp_path: Path
) -> None:
    path = tmp_path / "journal.sqlite"
    feed, pages = LiveFeed(), Pages(path, "cell", lambda: 1)
    server = Server(pages, feed, {})
    try:
        with Journal.create(path, meta=samples.meta()) as journal:
            journal.add_tests([BaselineTest(0, 0, TestEnd(samples.TEST, "passed", wall=0.5))])
            journal.set_plan(samples.MUTANTS, samples.LEFT_OUT, sources={"mission.py": samples.PROGRAM})
            journal.add_control(ControlEnd("tests/test_mission.py", "identity", True, "as it must"))
            feed.put(state(1))
            page.goto(server.address)
            _wait_for_version(page, 1)
            overview = page.inner_text("main")
            page.get_by_role("link", name="Tests", exact=True).click()
            tests = page.inner_text("main")
        assert "Nothing is judged yet" in overview
        assert "1 control run so far, none of them failed." in overview
        for text in ("not known to kill", "Every test killed", "Both control mutants"):
            assert text not in overview
        assert "0 of 1 test killed a mutant so far" in tests
    finally:
        feed.close()
        server.close()
