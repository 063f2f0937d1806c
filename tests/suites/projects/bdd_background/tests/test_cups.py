import mission
import pytest
import readings
from pytest_bdd import given, parsers, scenarios, then
from robot import Arm

scenarios("features/cups.feature")


@pytest.fixture(scope="module")
def cell():
    return {}


@given("an arm over two cups", target_fixture="arm")
def arm(cell):
    return cell.setdefault("arm", Arm())


@given(parsers.parse("cup {cup:d} was taken"))
def taken(cell, arm, cup):
    if not cell.get("taken"):
        cell["taken"] = True
        mission.stack_cup(arm, cup)


@then("the arm is holding a cup")
def holds(arm):
    assert readings.held(arm) is not None


@then("the arm holds the red cup")
def red(arm):
    assert readings.held(arm) == "red"


@then(parsers.parse("cup {cup:d} is left"))
def left(arm, cup):
    assert cup in arm.cups


@then("the arm is up")
def up(arm):
    assert arm.height == 0.2
