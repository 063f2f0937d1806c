"""Languages of robot programs: Python, and the contract of those that packages bring (``front_end.py``)."""
