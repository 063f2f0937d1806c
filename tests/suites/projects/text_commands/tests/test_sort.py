import link
import mission
import pytest


@pytest.mark.parametrize("colour, angle", [("red", 90), pytest.param("blue", -90, id="other")])
def test_box_ends_at_its_place(colour, angle):
    link.reset(colour)
    mission.sort_box()
    assert link.STATE["angle"] == angle


def test_log_and_state():
    link.reset("red")
    mission.sort_box()
    assert not link.STATE["held"]
    assert link.STATE["log"][0] == "pick"
