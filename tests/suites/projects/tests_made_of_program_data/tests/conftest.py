import mission


def pytest_generate_tests(metafunc):
    if "station" in metafunc.fixturenames:
        names = [f"{name}-{x:g}" for name, x in mission.STATIONS]
        metafunc.parametrize("station", [x for _, x in mission.STATIONS], ids=names)
