"""The executors, one file each: ``NAME``, and ``executor(request, tell)``, which opens it.

``tell`` is told what the user should know about where and how tasks run.
"""
