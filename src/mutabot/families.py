"""Names of the families of mutabot's own mutants of calls, and of the providers that make them.

A family is what a user asks for by ``--family`` or ``families``, and what has a score of its own. Operators
name the one they belong to. Families of packages are those of their providers (``mutabot.faults``), and an
operator on calls that a package brings may have one of its own.
"""

from __future__ import annotations

ROBOT = "robot"
GRADED = "graded"
#: their operators are those of ``mutabot_catalogue``
CATALOGUE = "catalogue"
MIDDLEWARE = "middleware"
#: mutabot's own mutants, which users do not choose
CONTROL = "control"

#: the core's own providers: faults of calls, and of messages and what else goes over a middleware
CALLS, MESSAGES = "calls", "messages"
#: their families, in the order in which they are listed
OF_CALLS = (ROBOT, GRADED, CATALOGUE, MIDDLEWARE)
#: the family without a choice of the user's
USUAL = (ROBOT,)
