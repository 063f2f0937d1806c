import mission
import pytest
from robot import Spindle


@pytest.fixture
def spindle(shift):
    spindle = Spindle()
    shift.append(spindle)
    return spindle


def test_drills(spindle):
    mission.drill(spindle)


class TestDepth:
    @pytest.fixture(scope="class", autouse=True)
    def deep(self, request):
        request.cls.depths = []
        yield
        assert max(self.depths) < 20

    def test_depth(self, spindle):
        mission.drill(spindle)
        self.depths.append(spindle.deepest)

    def test_nothing(self):
        pass
