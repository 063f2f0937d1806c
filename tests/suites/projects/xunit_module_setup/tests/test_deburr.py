import mission
from robot import Tool

tool = None


def setup_module():
    global tool
    tool = Tool()
    mission.deburr(tool)


def teardown_module():
    assert not tool.running


def test_tool_exists():
    assert tool is not None


def test_comes_back():
    assert tool.path[0] == tool.path[-1]


def test_four_corners():
    assert len(tool.path) == 5


class TestSecondPass:
    @classmethod
    def setup_class(cls):
        cls.tool = Tool()
        mission.deburr(cls.tool)

    def setup_method(self):
        self.heading = self.tool.heading

    def test_heading(self):
        assert self.heading == 0

    def test_inside(self):
        assert all(-1 <= x <= 51 and -1 <= y <= 51 for x, y in self.tool.path)
