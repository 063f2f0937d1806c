import mission


def test_first_stop(agv, logger, log):
    mission.deliver(agv, logger)
    assert "at 4.0" in log.read_text()


def test_second_stop(log):
    assert "at 6.5" in log.read_text()


def test_horn(agv, logger, log):
    mission.deliver(agv, logger)
    assert agv.honked
    assert log.read_text().splitlines()[-1] == "horn True"
