def test_height():
    assert cell_arm.z > 0.1  # noqa: F821  # it is one
