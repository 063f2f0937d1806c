"""Conventional mutation operators on program text: one file each, ``operator.py`` is the contract."""
