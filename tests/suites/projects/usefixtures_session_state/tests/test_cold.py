def test_it_starts_cold(spindle):
    assert not spindle.cooled
    assert spindle.rpm() == 0
