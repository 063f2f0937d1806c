"""URScript: programs of Universal Robots, ``.script`` and ``.urscript``."""
