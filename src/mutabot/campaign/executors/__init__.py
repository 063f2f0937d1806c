"""The executors, one file each, named by it; ``executor(request, tell)`` there opens it.

``tell`` is told what the user should know about where and how tasks run.
"""
