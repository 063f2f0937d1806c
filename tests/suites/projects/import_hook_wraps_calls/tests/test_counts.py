import counts
import mission


def test_counted():
    counts.CALLS.clear()
    assert mission.go(-2.0) == 2.0
    assert counts.CALLS == ["Arm", "abs", "move", "grip"]


def test_not_closed():
    counts.CALLS.clear()
    mission.go(2.0)
    assert "grip" not in counts.CALLS
