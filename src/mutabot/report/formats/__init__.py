"""Formats of other tools, one file each, which sets ``FORMAT``; ``report/format.py`` is the contract."""
