def test_take(station):
    assert station("take")[0] == "1"


def test_take_again(station):
    assert station("take") == ["2", "0.50"]


def test_drop(station):
    station("drop")


def test_all_gone(station):
    assert station("look") == ["0", "0.25"]
