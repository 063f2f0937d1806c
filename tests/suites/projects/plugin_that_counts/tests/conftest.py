import pytest
from robot import Arm


class Station:
    """Has one arm for the whole session, and looks at it when the last test is over."""

    def __init__(self):
        self._arm = Arm()

    @pytest.fixture
    def arm(self):
        return self._arm

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_teardown(self, item, nextitem):
        if nextitem is None:
            assert self._arm.z == 0.3


def pytest_configure(config):
    config.pluginmanager.register(Station(), "station")
