"""Conventional mutation operators on program text, one file each; ``operator.py`` defines their interface."""
