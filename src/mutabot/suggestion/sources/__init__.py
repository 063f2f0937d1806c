"""The text of a project: its test files, changes of them, and private copies in which they are made."""
