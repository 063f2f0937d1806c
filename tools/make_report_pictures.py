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

import mutabot

ROOT = Path(__file__).parents[1]
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
#: what of the program the mutant on the picture does, and how long after its fault it is shown, s
OPERATOR, LINE, AFTER = "skip", "    arm.move_by(z=-0.3)", 0.34
#: ms until all is drawn
_DRAWN = 300
#: lets the page show that moment
_SHOW = """(after) => {
  const range = document.querySelector(".slider input");
  document.querySelector(".slider button:nth-of-type(2)").click();
  range.value = Number(range.value) + after;
  range.dispatchEvent(new Event("input"));
}"""


def main(folder: Path) -> None:
    """Write all of them."""
    with tempfile.TemporaryDirectory() as name:
        project = Path(name) / "paper"
        shutil.copytree(ROOT / "examples" / "paper", project, ignore=shutil.ignore_patterns(".mutabot"))
        _mutabot(project, "run", "--rounds", "2", "--family", "robot,conventional")
        take(folder, project)


def take(folder: Path, project: Path) -> None:
    """Take the pictures of a project that has run."""
    from playwright.sync_api import sync_playwright  # noqa: PLC0415  # only tests and this have it

    browser_file = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser_file is None:
        sys.exit("no Chromium is installed")
    _mutabot(project, "report", "--html", str(project / "report"))
    campaign = mutabot.open(project)
    line = (campaign.source("mission.py") or "").split("\n").index(LINE) + 1
    wanted = (OPERATOR, line)
    shown = next(
        survivor.mutant.number
        for survivor in campaign.survivors
        if (survivor.mutant.operator, survivor.mutant.site.span.line) == wanted
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
        light.goto(f"{page_file}#/mutant/{shown}")
        light.wait_for_selector("canvas.scene")
        light.evaluate(_SHOW, AFTER)
        light.wait_for_timeout(_DRAWN)
        light.screenshot(path=folder / "report-mutant.png")
        dark = browser.new_page(viewport={"width": 1180, "height": 860}, color_scheme="dark")
        dark.goto(f"{page_file}#/source/mission.py")
        dark.wait_for_selector(".line.wanted")
        dark.wait_for_timeout(_DRAWN)
        dark.screenshot(path=folder / "report-source.png")
        browser.close()


def _mutabot(project: Path, *words: str) -> None:
    command: Sequence[str] = (sys.executable, "-m", "mutabot", "-C", str(project), *words)
    subprocess.run(command, check=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "img")
