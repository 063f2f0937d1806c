"""Families of mutants: their names, said once.

A family is what a user asks for by ``--family`` or ``families``, and what has a score of its own. Operators
name the one they belong to. A plug-in may name one that is not listed here: it is one of mutants of calls.
"""

from __future__ import annotations

ROBOT = "robot"
GRADED = "graded"
CATALOGUE = "catalogue"
MIDDLEWARE = "middleware"
CLASSICAL = "classical"
TEXT = "text"
#: mutabot's own mutants, which nobody asks for
CONTROL = "control"

#: families of mutants of calls, and of the program text; in the order of their numbers
OF_CALLS = (ROBOT, GRADED, CATALOGUE, MIDDLEWARE)
OF_TEXT = (CLASSICAL, TEXT)
#: all that can be asked for without a plug-in
FAMILIES = (*OF_CALLS, *OF_TEXT)
#: what is planted if nobody asks
USUAL = (ROBOT,)
