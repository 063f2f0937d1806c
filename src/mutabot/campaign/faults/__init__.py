"""The providers of faults: those of the core, and those that packages bring."""
