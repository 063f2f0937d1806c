import mission


def test_a_pause_changes_nothing(disc):
    mission.pause(disc)
    assert disc.pressure == 0.0


def test_polish(disc):
    mission.polish(disc)


def test_disc_stands_still(disc):
    assert not disc.spinning
