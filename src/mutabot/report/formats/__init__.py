"""Formats of other tools, one file each, with a function ``make``; ``report/format.py`` is the contract."""
