"""Bugs of public robot programs, and which operators plant them."""
