import mission


def test_pick(arm):
    mission.pick(arm)


def test_height(controller):
    assert controller.ask("z", 0.0) == 0.15
