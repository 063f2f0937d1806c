from unittest.mock import call, patch

import mission


def seam(length):
    return mission.weld(length)


def test_welds_a_seam():
    with (
        patch("mission.move_to", autospec=True) as move_to,
        patch.object(mission.robot, "tool") as tool,
        patch("mission.where", return_value=0.3) as where,
    ):
        assert seam(0.2) == 0.3
    assert [one.kwargs for one in move_to.mock_calls] == [{"speed": 0.5}, {}]
    assert tool.mock_calls == [call(True), call(on=False)]
    where.assert_called_once()


def test_moves_to_the_end():
    with patch("mission.robot"), patch.multiple("mission", where=lambda: 0.0, move_to=(moves := []).append):
        try:
            mission.weld(0.4)
        except TypeError:  # append takes no keyword
            assert moves == []


def test_moves_along(monkeypatch):
    moved = []
    monkeypatch.setattr("mission.move_to", lambda x, speed=0.1: moved.append(x))
    monkeypatch.setattr("robot.tool", lambda on: None)
    monkeypatch.setattr("mission.where", lambda: moved[-1])
    assert mission.weld(0.4) == 0.5
