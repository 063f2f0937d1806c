"""What lives beside the robot program, in its process.

It imports the standard library, wrapt, ``mutabot.model`` and ``mutabot.operators``, and nothing else.
"""
