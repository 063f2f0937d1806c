from plant import Plant

from press import press


def test_weak_parts_are_rejected():
    plant = Plant([2500, 900, 2100])
    assert press(plant, 3) == 2
    assert plant.good == [2500, 2100]
    assert plant.rejected == [900]


def test_the_press_is_up_at_the_end():
    plant = Plant([2500])
    press(plant, 1)
    assert not plant.tags["Press.Down"]
