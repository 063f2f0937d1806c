import runpy


def test_places():
    assert runpy.run_path("mission.py", run_name="__main__")["places"] == [30, 60, 90]


def test_end():
    assert runpy.run_path("mission.py", run_name="__main__")["arm"].turn == 0


def test_import_does_nothing():
    assert runpy.run_path("mission.py")["places"] == []
