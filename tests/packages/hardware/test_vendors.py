"""Guards and hardware mode with vendors' own client libraries, on controllers that speak their protocols."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.cli.app import main
from mutabot.config.options import Sample
from mutabot.errors import BaselineError
from mutabot.model import Outcome, Verdict
from tests.campaign.project import Quiet, outcomes, request_for
from tests.packages.hardware.vendors.controller import HARDWARE, Controller, Vendor
from tests.packages.hardware.vendors.modbus import MODBUS
from tests.packages.hardware.vendors.opcua import OPCUA
from tests.packages.hardware.vendors.ur import UR_RTDE, URSCRIPT, URX
from tests.packages.hardware.vendors.xarm import XARM

VENDORS = {
    "modbus": MODBUS, "opcua": OPCUA, "urx": URX, "urscript": URSCRIPT, "ur_rtde": UR_RTDE, "xarm": XARM,
}  # fmt: skip
#: the one whose client starts quickest
_QUICK = "modbus"
#: some mutants of calls and of the program text: most of them lead out of the guard
_SOME: dict[str, Any] = {
    "families": ("robot", "conventional"), "only": ("reverse", "repeat", "AOR"), "sample": Sample.parse("2"),
}  # fmt: skip


@pytest.fixture(
    params=[pytest.param(name, marks=() if name == _QUICK else pytest.mark.whole) for name in VENDORS]
)
def vendor(request: pytest.FixtureRequest) -> Vendor:
    found = VENDORS[request.param]
    missing = [package for package in found.packages if find_spec(package) is None]
    if missing:
        pytest.skip(f"{', '.join(missing)} is not installed: requirements-reports.lock, or make foreign")
    return found


@pytest.fixture
def controller(vendor: Vendor, monkeypatch: pytest.MonkeyPatch) -> Iterator[Controller]:
    with vendor.serve() as found:
        monkeypatch.setenv("CONTROLLER", found.address)
        yield found


def campaign(folder: Path, **changes: Any) -> list[Outcome]:
    return outcomes(run_campaign(request_for(folder, jobs=1, **changes), Quiet()))


def log(folder: Path) -> list[dict[str, Any]]:
    text = (folder / ".mutabot" / "hardware.jsonl").read_text(encoding="utf-8")
    return [json.loads(line) for line in text.splitlines()]


@pytest.mark.whole  # test_guard.py says it of a client of our own
def test_no_mutant_outside_the_guard_reaches_the_controller(
    vendor: Vendor, controller: Controller, tmp_path: Path
) -> None:
    found = campaign(vendor.write(tmp_path), **_SOME)
    kept = [outcome for outcome in found if outcome.verdict is Verdict.GUARDED]
    assert vendor.outside(controller) == []
    assert len(controller.of(vendor.moving)) > 2  # the original's, and those of mutants within the guard
    assert kept
    assert {str(outcome.message).split(": ")[0] for outcome in kept} == {vendor.operation}


@pytest.mark.whole
def test_without_a_guard_mutants_outside_it_reach_the_controller(
    vendor: Vendor, controller: Controller, tmp_path: Path
) -> None:
    campaign(vendor.write(tmp_path, guard=False), **_SOME)
    assert vendor.outside(controller)


def test_a_campaign_on_hardware_sends_what_the_log_says_and_nothing_else(
    vendor: Vendor, controller: Controller, tmp_path: Path
) -> None:
    folder = vendor.write(tmp_path, more=HARDWARE)
    assert (
        main(["-C", str(folder), "run", "--hardware", "yes", "-o", "hardware.stop=[]", "--only", "repeat"])
        == 0
    )
    sent = [entry for entry in log(folder) if entry.get("sent") == vendor.operation]
    assert sent
    assert vendor.outside(controller) == []
    assert len(sent) == len(
        [message for message in controller.received if message.name.startswith(vendor.counted)]
    )
    assert {outcome.engine for outcome in outcomes(folder / ".mutabot" / "journal.sqlite")} == {"replay"}


def test_a_command_that_the_guard_cannot_read_does_not_reach_the_controller(
    vendor: Vendor, controller: Controller, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = vendor.program.rstrip().splitlines()
    body = next(
        number for number, line in enumerate(lines) if line.strip().startswith(("def ", "async def "))
    )
    indent = lines[body + 1][: -len(lines[body + 1].lstrip())]
    program = "\n".join([*lines[: body + 1], indent + vendor.unreadable, *lines[body + 1 :]])
    folder = vendor.write(tmp_path, program=program, more=HARDWARE)
    assert main(["-C", str(folder), "run", "--hardware", "yes"]) != 0
    assert vendor.said in capsys.readouterr().err
    assert controller.received == []


def test_a_guard_that_the_original_violates_is_said_before_anything_moves(
    vendor: Vendor, controller: Controller, tmp_path: Path
) -> None:
    narrow = "\n[guard]\nforbid = ['*']\n"
    with pytest.raises(BaselineError, match="a guard keeps a command of the original program from the robot"):
        campaign(vendor.write(tmp_path, guard=False, more=narrow))
    assert controller.received == []
