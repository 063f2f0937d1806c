import mission
import pytest
from robot import Line


@pytest.fixture(scope="module")
def lines():
    lines = Line(), Line()
    mission.both_lines(*lines)
    return lines


def test_positions(lines):
    assert [line.at for line in lines] == [0.75, 0.75]


def test_stopped(lines):
    assert not any(line.running for line in lines)
