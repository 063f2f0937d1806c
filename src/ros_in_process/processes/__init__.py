"""Programs and processes that the project starts, in this process."""
