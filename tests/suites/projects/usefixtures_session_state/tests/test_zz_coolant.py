def test_coolant(spindle):
    assert spindle.cooled
