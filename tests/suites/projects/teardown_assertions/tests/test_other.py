def test_no_spindle_here(shift):
    assert len(shift) == 2
