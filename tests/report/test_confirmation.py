"""Every report says how many survivors the whole suite has confirmed, and of each whether it has."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from mutabot.model import Verdict
from mutabot.report.document import document
from mutabot.report.html.folder import campaign_data, mutant_page
from mutabot.report.terminal.campaign import print_results
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from report.material import made, stored
from results import samples

SURVIVORS = [outcome for outcome in samples.OUTCOMES if outcome.verdict is Verdict.SURVIVED]
TEXT = (
    f"0 of {len(SURVIVORS)} survivors confirmed by the whole suite; "
    "how many of the others are wrong is not known"
)


def campaign(folder: Path, **changes: Any) -> Any:
    outcomes = tuple(
        replace(outcome, **changes) if outcome in SURVIVORS else outcome for outcome in samples.OUTCOMES
    )
    return stored(folder, outcomes=outcomes)


def on_terminal(found: Any, number: int) -> tuple[str, str]:
    files = io.StringIO(), io.StringIO()
    print_results(make_console(files[0], width=200), found)
    print_mutant(make_console(files[1], width=200), found.mutant(str(number)), lambda _: None)
    return files[0].getvalue(), files[1].getvalue()


def test_what_was_not_confirmed_is_reported_in_all_of_them(tmp_path: Path) -> None:
    found = campaign(tmp_path, confirmed=False)
    survivor = next(result for result in found.survivors if result.outcomes[0].confirmed is False)
    of_all, of_one = on_terminal(found, survivor.mutant.number)
    assert TEXT in of_all
    assert "not confirmed by the whole suite" in of_one
    assert f"{TEXT}." in made("markdown", found)
    (notice,) = json.loads(made("sarif", found))["runs"][0]["invocations"][0]["toolExecutionNotifications"]
    assert notice == {"level": "note", "message": {"text": f"{TEXT}."}}
    assert campaign_data(found, "cell")["confirmed"] == TEXT
    assert "'confirmed': False" in str(mutant_page(survivor))
    data = document(found)
    assert data["confirmation"]["text"] == TEXT
    assert data["confirmation"]["left"] == len(SURVIVORS)
    assert [
        mutant["rounds"][0]["confirmed"] for mutant in data["mutants"] if mutant["id"] == survivor.mutant.id
    ] == [False]


def test_nothing_is_reported_where_all_were_run_with_the_whole_suite(tmp_path: Path) -> None:
    found = campaign(tmp_path)
    texts = *on_terminal(found, 1), made("markdown", found), made("sarif", found)
    assert not any("confirmed" in text for text in texts)
    assert document(found)["confirmation"] is None
