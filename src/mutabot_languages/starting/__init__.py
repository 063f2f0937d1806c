"""Projects to start from, for robot programs that have no tests yet."""
