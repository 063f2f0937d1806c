"""Where the processes of a job tell what they do, and which signals say what about their ends."""

from __future__ import annotations

import signal

#: this folder, in the home of the test process
FOLDER = "processes"
#: environment variable that names this folder; Python processes that find it look for what they are to do
VARIABLE = "MUTABOT_PROCESSES"
#: file in it with what wakes a process: see ``inside.processes.startup.sitecustomize``
WAKE = "wake"
#: file in it with the number of the running test in eight bytes, 0 before any; the next eight are not 0
#: once a process below the tests could not write what it had to tell
NOW = "now"
#: file in it with the tests' node ids, one a line as JSON, in the order of their numbers from 1
TESTS = "tests"
#: how the files of events end, one for each process, and the name of the test process's
SUFFIX, SESSION = ".jsonl", "session"
#: exit code of a test process, or of a fork of it, that could not write what it had to tell
UNWRITTEN = 117


#: a program dies of these by its own fault; others come from outside
OWN_FAULT = {signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL}
#: stands for any process, as in kill(2)
ANYBODY = -1
