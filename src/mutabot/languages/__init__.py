"""Languages of robot programs: one file each, ``front_end.py`` is the contract."""
