"""Programs and processes that the project starts, simulated in this process."""
