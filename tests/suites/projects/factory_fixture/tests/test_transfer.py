import mission
import pytest
from robot import Arm


@pytest.fixture(scope="module")
def make_arm():
    made = {}

    def make(name, **table):
        if name not in made:
            made[name] = Arm({int(place[1:]): part for place, part in table.items()})
            mission.transfer(made[name], 3, 7)
        return made[name]

    return make


def test_make(make_arm):
    assert make_arm("one", p3="gear").carried is None


def test_the_part_is_gone(make_arm):
    assert 3 not in make_arm("one", p3="gear").table


def test_the_part_is_there(make_arm):
    assert make_arm("one", p3="gear").table[7] == "gear"


def test_nothing_to_transfer(make_arm):
    assert make_arm("two").table == {}
