"""Which signals say what about a program that ended by one."""

from __future__ import annotations

import signal

#: a program dies of these by its own fault; others come from outside
OWN_FAULT = {signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL}
#: stands for any process, as in kill(2)
ANYBODY = -1
