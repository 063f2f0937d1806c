"""Take the pictures of the report in docs/img: of the published program, all its mutants in two rounds.

Use: ``make pictures``, or ``python tools/make_report_pictures.py [FOLDER]``. It needs Chromium and Playwright
(requirements-reports.lock), and runs the campaign in a copy of the example.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mutabot

ROOT = Path(__file__).parents[1]
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
#: what of the program the mutant on the picture does
OPERATOR, LINE = "skip", "    arm.move_by(z=-0.3)"


def main(folder: Path) -> None:
    """Write all of them."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415  # only tests and this have it

    browser_file = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser_file is None:
        sys.exit("no Chromium is installed")
    with tempfile.TemporaryDirectory() as name:
        project = Path(name) / "paper"
        shutil.copytree(ROOT / "examples" / "paper", project, ignore=shutil.ignore_patterns(".mutabot"))
        _mutabot(project, "run", "--rounds", "2", "--family", "robot,conventional")
        _mutabot(project, "report", "--html", str(project / "report"))
        campaign = mutabot.open(project)
        line = (campaign.source("mission.py") or "").split("\n").index(LINE) + 1
        shown = next(
            one
            for one in campaign.survivors
            if (one.mutant.operator, one.mutant.site.span.line) == (OPERATOR, line)
        )
        page_file = (project / "report" / "index.html").as_uri()
        with sync_playwright() as playwright:
            sandbox = [] if os.getuid() else ["--no-sandbox"]
            browser = playwright.chromium.launch(executable_path=browser_file, args=sandbox)
            light = browser.new_page(viewport={"width": 1180, "height": 860}, color_scheme="light")
            light.goto(page_file)
            light.wait_for_selector("main h1")
            light.screenshot(path=folder / "report-overview.png")
            light.set_viewport_size({"width": 1280, "height": 880})
            light.goto(f"{page_file}#/mutant/{shown.mutant.number}")
            _show(light, "canvas.scene", "#robot")
            light.screenshot(path=folder / "report-mutant.png")
            dark = browser.new_page(viewport={"width": 1180, "height": 860}, color_scheme="dark")
            dark.goto(f"{page_file}#/source/mission.py")
            _show(dark, ".code", "#L11")
            dark.screenshot(path=folder / "report-source.png")
            browser.close()


def _mutabot(project: Path, *words: str) -> None:
    command: Sequence[str] = (sys.executable, "-m", "mutabot", "-C", str(project), *words)
    subprocess.run(command, check=True)


def _show(page: Any, wanted: str, top: str) -> None:
    """Wait until something is drawn, and put a part at the top, below the line that stays there."""
    page.wait_for_selector(wanted)
    page.evaluate("(top) => scrollTo(0, document.querySelector(top).getBoundingClientRect().top - 70)", top)
    page.wait_for_timeout(300)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "img")
