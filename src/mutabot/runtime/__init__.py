"""What lives beside the robot program, in its process.

It imports the standard library, wrapt, pytest, and of mutabot only ``model``, ``languages``, ``border`` and
``operators``.
Its rooms: ``suite`` makes pytest run a job, ``targets`` finds what the vocabulary names, ``calls`` and
``text`` are the two ways of a mutant into it, ``readings`` looks at the world,
``fork`` makes branches and copies, and ``watching`` is for ``mutabot init``. To follow one call, begin
at ``calls/passing.py``.
"""

import os

#: where all of it lies: frames in these files are ours
FOLDER = os.path.dirname(os.path.realpath(__file__))
