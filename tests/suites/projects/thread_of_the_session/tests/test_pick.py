import mission


def test_pick(arm):
    mission.pick(arm)


def test_height(controller):
    assert controller.at("z") == 0.15


def test_angle(controller):
    assert controller.at("angle") < 90.0
