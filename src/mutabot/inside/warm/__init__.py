"""Python processes that begin warm: forked from one that has imported what such processes import."""
