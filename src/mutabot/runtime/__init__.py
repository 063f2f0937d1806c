"""The part of mutabot in the process of the robot program.

It imports the standard library, wrapt, pytest, and of mutabot only ``model``, ``languages``, ``evidence``,
``extensions`` and ``operators``. ``session_hooks`` and ``test_hooks`` make pytest run a job, and ``session``
holds what stands in the program for it: ``targets`` finds what the vocabulary names, ``interception`` and
``program_text`` are the two ways of a mutant into it, ``observation`` looks at the world, ``isolation``
forks, and ``processes`` follows what the tests start. To follow one call, begin at
``interception/dispatcher.py``.
"""

import os

#: where all of it lies: frames in these files are ours
FOLDER = os.path.dirname(os.path.realpath(__file__))
