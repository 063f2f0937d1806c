"""The report in headless Chromium, from disk: it opens, can be used, and harms nobody."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import mutabot
import schemas
from mutabot.journal.files import recordings_path
from mutabot.model import Diverged, Mutant, Outcome, Role, Verdict
from report.html import reports
from results import samples
from results.thresholds import journals
from results.thresholds.journals import Rungs

sync_api = pytest.importorskip("playwright.sync_api", reason="requirements-reports.lock is not installed")

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed")
#: every kind of page
PAGES = (
    "#/", "#/mutants", "#/mutant/2", "#/mutant/1", "#/source/mission.py", "#/tests", "#/operators",
    "#/mutant/99", "#/nowhere",
)  # fmt: skip

#: puts scripts into the page that are none of its own
_INTRUDE = """() => {
  const one = document.createElement("script");
  one.textContent = "window.pwned = 1";
  const two = document.createElement("img");
  two.setAttribute("onerror", "window.pwned = 2");
  two.src = "x";
  document.body.append(one, two);
}"""


class Visit:
    """A page, and what went wrong in it."""

    def __init__(self, page: Any, file: Path) -> None:
        self.page, self._file = page, file
        self.wrong: list[str] = []
        page.on(
            "console",
            lambda message: self.wrong.append(message.text) if message.type in ("error", "warning") else None,
        )
        page.on("pageerror", lambda error: self.wrong.append(str(error)))
        page.on("dialog", lambda dialog: self.wrong.append(dialog.message))
        page.on("requestfailed", self._failed)
        page.on(
            "request",
            lambda request: None if request.url.startswith("file:") else self.wrong.append(request.url),
        )

    def _failed(self, request: Any) -> None:
        # A page that is left or reloaded gives up what it still loads: the browser asks for the icon late.
        if request.failure != "net::ERR_ABORTED":
            self.wrong.append(f"{request.url}: {request.failure}")

    def open(self, address: str) -> None:
        """Go there, and wait until it is drawn."""
        self.page.goto(f"{self._file.as_uri()}{address}")
        self.page.wait_for_selector("body:not(:has(.wait)) main h1")

    def settled(self) -> None:
        """Wait until two frames have been drawn."""
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    sandbox = [] if os.getuid() else ["--no-sandbox"]
    with sync_api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=sandbox)
        yield found
        found.close()


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return reports.plain(tmp_path_factory.mktemp("plain"))


@pytest.fixture(scope="module")
def evil(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return reports.evil(tmp_path_factory.mktemp("evil"))


@pytest.fixture
def visit(browser: Any, plain: Path) -> Iterator[Visit]:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    yield Visit(page, plain)
    page.close()


def test_every_page_opens_from_disk_without_an_error_and_without_a_network(visit: Visit) -> None:
    titles = set()
    for address in PAGES:
        visit.open(address)
        titles.add(visit.page.title())
    assert len(titles) == len(PAGES)
    assert visit.wrong == []


def test_the_list_is_searched_filtered_and_sorted_and_the_address_remembers(visit: Visit) -> None:
    visit.open("#/mutants")
    rows = visit.page.locator("table.mutants tbody tr")
    assert rows.count() == len(samples.MUTANTS)
    visit.page.get_by_label("Search").fill("tracker noise")
    assert rows.count() == 1
    assert "1 mutant of 5" in visit.page.locator(".result-count").inner_text()
    visit.page.get_by_label("Search").fill("")
    visit.page.get_by_role("button", name="survived").click()
    assert rows.count() == 2
    visit.page.get_by_role("button", name="deviation").click()
    assert visit.page.locator("th[aria-sort=descending]").inner_text().startswith("deviation")
    assert rows.first.locator("a.open").inner_text() == samples.SKIP.description
    visit.page.reload()
    assert rows.count() == 2
    visit.page.get_by_label("Search").fill("nothing has this text")
    assert "No matching mutants" in visit.page.locator("#results").inner_text()
    assert visit.wrong == []


@pytest.mark.parametrize(
    ("copies", "expected"), [(0, "2 survivors\n"), (40, "42 survivors without a measured effect")]
)
def test_survivors_are_described_if_nothing_else_says_which_they_are_and_are_in_order(
    visit: Visit, copies: int, expected: str
) -> None:
    visit.open("#/mutants")
    visit.page.evaluate(
        """(copies) => {
            const { mutants, survivors, byNumber } = mutabot.campaign, survivor = byNumber.get(survivors[0]);
            for (const one of mutants) Object.assign(one, { indistinguishable: true, deviation: 0 });
            for (let at = copies; at; at -= 1) {
                mutants.push({ ...survivor, number: 100 + at });
                survivors.push(100 + at);
                byNumber.set(100 + at, mutants.at(-1));
            }
            location.hash = "#/";
        }""",
        copies,
    )
    section = visit.page.locator("section[aria-labelledby=survivors]")
    section.wait_for()
    assert expected in section.inner_text()
    assert section.locator("ol.findings li").count() == (0 if copies else 2)
    links = [link.inner_text() for link in section.locator("p.hint a").all()]
    numbers = [int(text) for text in links if text.isdecimal()]
    assert len(numbers) == (30 if copies else 0)
    assert numbers == sorted(numbers)
    assert (" and 12 more" in section.inner_text()) == bool(copies)


def test_survivors_without_a_deviation_stand_in_the_order_of_the_terminal(
    browser: Any, tmp_path: Path
) -> None:
    unknown = Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED)
    differs = Outcome(samples.SKIP.id, 0, Verdict.SURVIVED, divergence=("1 call fewer",))
    page = browser.new_page()
    visit = Visit(page, reports.plain(tmp_path, outcomes=(unknown, differs)))
    visit.open("#/")
    links = page.locator("section[aria-labelledby=survivors] ol.findings a").all()
    expected = [samples.SKIP, samples.REVERSE]
    assert [link.inner_text().split(maxsplit=1) for link in links] == [
        [str(mutant.number), mutant.description] for mutant in expected
    ]
    page.close()


def test_a_page_without_movements_says_what_would_record_them(visit: Visit) -> None:
    visit.open("#/")
    visit.page.evaluate(
        """() => {
            const recording = mutabot.recordings.recording;
            mutabot.recordings.recording = (data) => recording({ ...data, tracks: [] });
            location.hash = "#/mutant/2";
        }"""
    )
    visit.page.wait_for_selector(".events, #events")
    text = visit.page.locator("section.robot").inner_text()
    assert "recorded where the simulator has a feed" in text
    assert "docs/evidence.md" in text
    assert visit.page.locator("canvas.scene").count() == 0
    assert visit.wrong == []


def test_the_source_of_a_mutant_is_in_a_picture_of_the_whole_page(visit: Visit) -> None:
    visit.open("#/mutant/2")
    code = visit.page.locator(".code.small")
    code.wait_for()
    # it is below the first screen
    assert not code.evaluate("(box) => box.getBoundingClientRect().top < innerHeight")
    assert "gripper.command" in code.inner_text()


def test_what_the_list_is_sorted_by_takes_two_lines_of_a_telephone(browser: Any, plain: Path) -> None:
    page = browser.new_page(viewport={"width": 390, "height": 800})
    visit = Visit(page, plain)
    visit.open("#/mutants")
    heads = [head.bounding_box() for head in page.locator("table.mutants thead th:visible").all()]
    assert len(heads) == 6
    assert len({round(head["y"]) for head in heads}) <= 2
    page.close()


def test_all_of_it_can_be_used_by_keyboard(visit: Visit) -> None:
    visit.open("#/")
    keys = visit.page.keyboard
    keys.press("Tab")
    assert visit.page.evaluate("document.activeElement.textContent") == "Skip to the content"
    keys.press("/")
    visit.page.wait_for_selector("#search:focus")
    keys.type("skip")
    keys.press("Escape")
    keys.press("j")
    keys.press("Enter")
    visit.page.wait_for_selector("canvas.scene")
    assert visit.page.url.endswith("#/mutant/2")
    visit.page.locator("canvas.scene").focus()
    before = visit.page.locator("canvas.scene").evaluate("(one) => one.toDataURL()")
    keys.press("ArrowLeft")
    visit.settled()
    assert visit.page.locator("canvas.scene").evaluate("(one) => one.toDataURL()") != before
    moment = visit.page.get_by_label("Moment", exact=True)
    at = float(moment.input_value())
    keys.press("]")
    assert float(moment.input_value()) == pytest.approx(at + 0.1)
    visit.open("#/mutants")
    visit.open("#/mutant/2")
    keys.press("n")
    visit.page.wait_for_url("**#/mutant/3")
    keys.press("?")
    assert visit.page.get_by_role("dialog").is_visible()
    keys.press("Escape")
    assert visit.page.get_by_role("dialog").count() == 0
    assert visit.wrong == []


def test_a_mutant_s_page_shows_what_the_robot_did_and_who_looked(visit: Visit) -> None:
    visit.open("#/mutant/2")
    visit.page.wait_for_selector("canvas.scene")
    text = visit.page.locator("main").inner_text()
    assert "box slipped at 5.0 s" in text
    assert "x == approx(0.5, abs=0.1)" in text
    assert "max. difference 0.2 m" in text
    assert visit.page.locator("figure.chart").count() >= 6
    assert visit.page.locator(".events tr.faulty").count() == 1
    assert "Arm.move_by by {dx}" in text  # a command is named by its text
    assert "Run mutabot suggest --only 2 to search for a check" in text  # nothing was suggested yet


@pytest.mark.parametrize("width", [1280, 390])
def test_what_the_robot_did_comes_before_the_source_and_what_the_mutant_is(
    browser: Any, plain: Path, width: int
) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    Visit(page, plain).open("#/mutant/2")
    page.wait_for_selector("canvas.scene")
    tops = {
        name: page.locator(name).bounding_box()["y"]
        for name in ("canvas.scene", "#there", "#facts", "#events")
    }
    assert [*tops] == sorted(tops, key=tops.__getitem__)
    assert tops["canvas.scene"] < 700
    page.close()


def test_the_survivors_beside_a_mutant_in_the_source_are_one_key_away(visit: Visit) -> None:
    for number, beside in {1: ("2", "4"), 2: (None, "4"), 4: ("2", None), 5: ("4", None)}.items():
        visit.open(f"#/mutant/{number}")
        links = visit.page.get_by_role(
            "navigation", name="Survivors beside this one in the source"
        ).get_by_role("link")
        assert [link.get_attribute("href") for link in links.all()] == [
            f"#/mutant/{to}" for to in beside if to
        ]
        for key, to in zip(("P", "N"), beside, strict=True):
            if to is not None:
                visit.open(f"#/mutant/{number}")
                visit.page.keyboard.press(f"Shift+{key}")
                visit.page.wait_for_url(f"**#/mutant/{to}")
    assert visit.wrong == []


#: notes what is written on canvases, with both ends of each text, px
_NOTE_NAMES = """window.names = [];
const write = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  const wide = this.measureText(text).width;
  const begin = x - {left: 0, center: wide / 2, right: wide}[this.textAlign];
  window.names.push([text, begin, begin + wide]);
  return write.call(this, text, x, y);
};"""
#: how wide and high the mutant's path is, as shares of the canvas
_REACH = """(canvas) => {
  const wanted = mutabot.ink("mutant").match(/[0-9]+/g).map(Number);
  const { width, height } = canvas, { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  const xs = [], ys = [];
  for (let at = 0; at < data.length; at += 4) {
    if (wanted.some((value, axis) => Math.abs(data[at + axis] - value) > 12)) continue;
    xs.push(at / 4 % width);
    ys.push(at / 4 / width);
  }
  const end = (all, which) => all.reduce((one, other) => which(one, other));
  const reach = (all, size) => (end(all, Math.max) - end(all, Math.min)) / size;
  return [reach(xs, width), reach(ys, height)];
}"""


@pytest.mark.parametrize("width", [1280, 390])
def test_the_paths_fill_the_view_and_names_stay_whole(browser: Any, plain: Path, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900})
    page.add_init_script(_NOTE_NAMES)
    visit = Visit(page, plain)
    visit.open("#/mutant/2")
    scene = page.locator("canvas.scene")
    scene.wait_for()
    visit.settled()
    assert 0.6 < max(scene.evaluate(_REACH)) < 1
    page.evaluate("window.names.length = 0")
    page.get_by_role("button", name="Top", exact=True).click()
    visit.settled()
    assert 0.6 < max(scene.evaluate(_REACH)) < 1
    names = page.evaluate("window.names")
    wide = scene.bounding_box()["width"]
    assert {"fault 5 s", "tool", "box, original"} <= {text for text, _, _ in names}
    assert [text for text, begin, end in names if begin < 0 or end > wide] == []
    page.close()


def test_the_robot_is_drawn_and_has_no_curves(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    visit = Visit(page, reports.plain(tmp_path, has_arm=True))
    visit.open("#/mutant/2")
    scene = page.locator("canvas.scene")
    scene.wait_for()
    visit.settled()
    whole = scene.evaluate("(one) => one.toDataURL()")
    page.get_by_label("robot", exact=True).uncheck()
    visit.settled()
    assert scene.evaluate("(one) => one.toDataURL()") != whole
    names = page.locator("figure.chart strong").all_text_contents()
    assert "tool x" in names
    assert not [name for name in names if name.startswith("arm")]
    assert visit.wrong == []
    page.close()


def test_j_and_k_lead_from_survivor_to_survivor_of_the_source(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    # another survivor of this file
    outcomes = tuple(
        replace(outcome, mutant=samples.REVERSE.id) if outcome.mutant == samples.NEGATE.id else outcome
        for outcome in samples.OUTCOMES
        if outcome.mutant != samples.REVERSE.id
    )
    visit = Visit(page, reports.plain(tmp_path, outcomes=outcomes))
    visit.open("#/source/mission.py")
    wanted = page.locator(".line.wanted")
    wanted.wait_for()
    seen = [wanted.get_attribute("id")]
    for key in "jjkk":
        page.keyboard.press(key)
        seen.append(wanted.get_attribute("id"))
    first, last = (f"L{mutant.site.span.line}" for mutant in (samples.SKIP, samples.REVERSE))
    assert seen == [first, last, last, first, first]
    assert visit.wrong == []
    page.close()


def test_files_are_a_tree_with_the_scores_of_the_overview(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page()
    moved = "cell/arm/mission.py"
    mutants = {mutant.id: _in_file(mutant, moved) for mutant in samples.MUTANTS}
    outcomes = tuple(replace(outcome, mutant=mutants[outcome.mutant].id) for outcome in samples.OUTCOMES)
    visit = Visit(page, reports.plain(tmp_path, mutants=tuple(mutants.values()), outcomes=outcomes))
    visit.open("#/")
    overview = {
        row.locator("th").inner_text(): row.locator("td").first.inner_text().split(" %")[0]
        for row in page.locator("table.scores tbody tr").all()
    }
    visit.open(f"#/source/{moved}")
    tree = page.get_by_role("navigation", name="Files")
    folders = [element.inner_text().lstrip("▾ ") for element in tree.locator("summary .name").all()]
    assert folders == ["cell/arm/", "tests/"]
    shown = [element.inner_text() for element in tree.locator("summary b").all()]
    assert shown == [f"{float(overview[name]):.0f} %" for name in ("robot · program", "robot · oracle")]
    assert tree.locator("a[aria-current=page]").inner_text().startswith("mission.py")
    tree.locator("summary").first.click()
    assert not tree.get_by_role("link", name="mission.py").is_visible()
    assert visit.wrong == []
    page.close()


def _in_file(mutant: Mutant, file: str) -> Mutant:
    """The same mutant, of the program in another file."""
    if mutant.site.role is not Role.PROGRAM:
        return mutant
    return replace(mutant, site=replace(mutant.site, span=replace(mutant.site.span, file=file)))


@pytest.mark.parametrize("rounds", [2, 3])
def test_only_a_whole_campaign_says_that_every_mutant_was_run(
    browser: Any, tmp_path: Path, rounds: int
) -> None:
    outcomes = [outcome for outcome in samples.OUTCOMES if outcome.mutant == samples.SKIP.id]
    journal = samples.write_journal(
        tmp_path / "journal.sqlite", mutants=(samples.SKIP,), outcomes=tuple(outcomes), rounds=rounds
    )
    assert len(outcomes) == 2
    page = browser.new_page()
    Visit(page, reports.write(tmp_path / "report", journal, mutabot.open(journal)).page).open("#/")
    text = page.locator("main").inner_text()
    assert ("Every mutant is counted." in text) is (rounds == 2)
    assert ("so far" in text) is (rounds == 3)
    page.close()


def test_a_sentence_sums_up_the_thresholds(browser: Any, tmp_path: Path) -> None:
    ladders = Rungs(["SSSSSSS"] * 2), Rungs(["SSSSCCC"] * 2, direction="-")
    journal = journals.write(tmp_path / "journal.sqlite", *ladders)
    page = browser.new_page()
    with_ladders = Visit(page, reports.write(tmp_path / "report", journal, mutabot.open(journal)).page)
    with_ladders.open("#/")
    text = page.locator("main").inner_text()
    assert "1 of 2 graded faults not noticed even at the largest size tried; 1 noticed in every round" in text
    assert with_ladders.wrong == []
    page.close()


def test_the_theme_is_chosen_and_kept(visit: Visit) -> None:
    visit.open("#/")
    colour = "getComputedStyle(document.body).backgroundColor"
    light = visit.page.evaluate(colour)
    button = visit.page.get_by_role("button", name="Theme")
    button.click()
    button.click()
    assert visit.page.evaluate("document.documentElement.dataset.theme") == "dark"
    dark = visit.page.evaluate(colour)
    assert dark != light
    visit.page.reload()
    assert visit.page.evaluate(colour) == dark


@pytest.mark.whole
@pytest.mark.parametrize(
    ("theme", "rules"),
    [("light", {}), ("dark", {"runOnly": ["color-contrast"]})],
)
def test_axe_finds_nothing_serious_on_any_page(
    browser: Any, plain: Path, theme: str, rules: dict[str, Any]
) -> None:
    try:
        axe = schemas.text(schemas.AXE)
    except schemas.NoSchemaError as error:
        pytest.skip(f"no axe here: {error}")
    page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=theme)
    visit = Visit(page, plain)
    found = []
    for address in PAGES:
        visit.open(address)
        page.evaluate(axe)
        for violation in page.evaluate(
            "(rules) => axe.run({...rules, preload: false, resultTypes: ['violations']})", rules
        )["violations"]:
            if violation["impact"] in ("serious", "critical"):
                places = [(node["target"], node.get("failureSummary", "")) for node in violation["nodes"][:3]]
                found.append((address, violation["id"], places))
    page.close()
    assert found == []


@pytest.mark.whole
def test_no_page_is_wider_than_a_telephone(browser: Any, plain: Path, evil: Path) -> None:
    page = browser.new_page(viewport={"width": 400, "height": 800})
    wide = []
    for file in (plain, evil):
        visit = Visit(page, file)
        for address in PAGES:
            visit.open(address)
            width = page.evaluate("document.documentElement.scrollWidth")
            wide += [(address, width)] if width > 400 else []
    page.close()
    assert wide == []


def test_texts_that_mean_harm_are_shown_and_do_nothing(browser: Any, evil: Path) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    visit = Visit(page, evil)
    for address in PAGES:
        visit.open(address)
        visit.settled()
        assert page.evaluate("window.pwned") is None
        assert page.locator("main script, main img, main svg[onload]").count() == 0
        assert page.locator("script:not([src])").count() == 0
    visit.open("#/mutants")
    text = page.locator("main").inner_text()
    assert "</script><script>window.pwned = 1</script>" in text
    assert "⟨U+202E⟩gnp.exe" in text
    assert "\u202e" not in text
    assert visit.wrong == []
    page.close()


def test_the_page_lets_no_script_in_that_is_not_its_own(visit: Visit) -> None:
    visit.open("#/")
    visit.page.evaluate(_INTRUDE)
    visit.settled()
    assert visit.page.evaluate("window.pwned") is None
    assert any("Content Security Policy" in problem for problem in visit.wrong)


@pytest.mark.parametrize("known", [0, 3])
def test_a_campaign_that_was_interrupted_says_so_and_what_to_do(
    browser: Any, tmp_path: Path, known: int
) -> None:
    page = browser.new_page()
    visit = Visit(page, reports.plain(tmp_path, outcomes=samples.OUTCOMES[:known], finish="interrupted"))
    for address in ("#/mutant/2", "#/tests", "#/operators"):
        visit.open(address)
    visit.open("#/")
    assert "not complete (interrupted)" in page.locator("main").inner_text()
    assert visit.wrong == []
    page.close()


def test_the_timeline_has_a_time_on_each_side_and_one_column_on_a_phone(visit: Visit) -> None:
    visit.open("#/mutant/2")
    visit.page.wait_for_selector("canvas.scene")
    row = visit.page.locator(".events tr.faulty")
    assert [row.locator(f"td[data-side={side}] .time").count() for side in ("original", "mutant")] == [1, 1]
    visit.page.set_viewport_size({"width": 400, "height": 900})
    original, mutant = (
        row.locator(f"td[data-side={side}]").bounding_box() for side in ("original", "mutant")
    )
    assert mutant["x"] == original["x"]
    assert mutant["y"] > original["y"]
    assert visit.page.evaluate("document.documentElement.scrollWidth") <= 400
    assert visit.wrong == []


def test_an_accepted_survivor_is_a_state_of_its_own_on_each_page(browser: Any, tmp_path: Path) -> None:
    accepted = {"mutants": {samples.SKIP.id: {"why": "it is open", "source": "a.toml:1", "date": ""}}}
    journal = samples.write_journal(tmp_path / "journal.sqlite", accepted=accepted)
    file = reports.write(tmp_path / "report", journal, mutabot.open(journal)).page
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    try:
        visit = Visit(page, file)
        visit.open("#/")
        text = page.inner_text("main")
        assert "1 mutant: it survived, and that was accepted with a reason" in text
        assert samples.SKIP.description not in text
        visit.open("#/mutants?status=accepted")
        assert page.locator("table.mutants tbody tr").count() == 1
        assert "accepted: it is open" in page.inner_text("table.mutants")
        visit.open("#/operators")
        row = page.locator("table.operators tbody tr", has_text="skip").first
        assert row.locator('[data-letter="A"]').inner_text() == "2"
        assert row.locator('[data-letter="S"]').inner_text() == "·"
        assert visit.wrong == []
    finally:
        page.close()


def test_a_mutant_s_page_gives_the_values_of_its_story_and_fits_a_phone(browser: Any, tmp_path: Path) -> None:
    found = Diverged("tests/test_a.py::test_told", None, "", "it is late", example=(0.25000002, 0.7500000003))
    outcome = Outcome(
        samples.NEGATE.id, 0, Verdict.SURVIVED, example=(0.125, -0.125), hits=3, acted=3, tests=2,
        diverged=(found,), divergence=(f"x: 1 instead of 2 (in {'a_very_long_name_' * 6})",),
    )  # fmt: skip
    journal = samples.write_journal(tmp_path / "journal.sqlite", outcomes=(outcome,))
    file = reports.write(tmp_path / "report", journal, mutabot.open(journal)).page
    page = browser.new_page(viewport={"width": 400, "height": 900})
    try:
        visit = Visit(page, file)
        visit.open("#/mutant/4")
        page.wait_for_selector(".round-box")
        assert page.locator("table.values tbody tr").all_inner_texts() == ["1\t0.25 m\t0.75 m"]
        assert page.evaluate("document.documentElement.scrollWidth") <= 400
        assert visit.wrong == []
    finally:
        page.close()


@pytest.mark.parametrize("is_recorded", [True, False])
def test_a_page_without_recordings_says_whether_the_campaign_has_any(
    browser: Any, tmp_path: Path, is_recorded: bool
) -> None:
    journal, stored = reports.campaign(tmp_path)
    if not is_recorded:
        recordings_path(journal).unlink()
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    visit = Visit(page, reports.write(tmp_path / "report", journal, stored).page)
    killed = next(result for result in stored.mutants if result.mutant == samples.REVERSE)
    visit.open(f"#/mutant/{killed.mutant.number}")
    said = page.locator("section.robot").inner_text()
    assert ("Nothing was recorded in this campaign." in said) == (not is_recorded)
    assert ("own cells" in said) == is_recorded  # which is no reason where recording is off
    visit.open("#/mutant/2")  # its recordings are told of in the journal
    assert page.get_by_text("Its recordings were not kept.").is_visible() == (not is_recorded)
    assert visit.wrong == []
    page.close()


def headings(visit: Visit, mutant: int) -> list[str]:
    """The headings of a mutant's page."""
    visit.open(f"#/mutant/{mutant}")
    return visit.page.locator("main h2").all_inner_texts()


def test_a_mutant_that_no_test_reaches_is_reported_once(browser: Any, tmp_path: Path) -> None:
    ends = tuple(Outcome(samples.REVERSE.id, number, Verdict.NOT_COVERED) for number in range(2))
    page = browser.new_page()
    visit = Visit(page, reports.plain(tmp_path, outcomes=ends))
    assert not {"What the robot did", "Checks that ran"} & {*headings(visit, samples.REVERSE.number)}
    assert "What to do" in headings(visit, samples.REVERSE.number)
    assert visit.wrong == []
    page.close()


def test_a_project_without_a_robot_has_no_view_of_what_it_did(browser: Any, tmp_path: Path) -> None:
    mutants = tuple(
        replace(mutant, operation="", family="conventional") for mutant in (samples.SKIP, samples.REVERSE)
    )
    ends = tuple(Outcome(mutant.id, number, Verdict.SURVIVED) for mutant in mutants for number in range(2))
    page = browser.new_page()
    visit = Visit(page, reports.plain(tmp_path, mutants=mutants, outcomes=ends))
    assert "What the robot did" not in headings(visit, samples.REVERSE.number)
    assert "rounds" in page.locator("p.under").inner_text()
    assert visit.wrong == []
    page.close()


def test_code_in_what_an_operator_does_stands_as_code(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page()
    operators = {"skip": "A command such as `lift/5` is not carried out."}
    visit = Visit(page, reports.plain(tmp_path, operators=operators))
    for address in ("#/operators", f"#/mutant/{samples.SKIP.number}"):
        visit.open(address)
        assert page.locator("small code").first.inner_text() == "lift/5"
        assert "`" not in page.locator("main").inner_text()
    assert visit.wrong == []
    page.close()
