"""Finding detection thresholds with as few runs as they take."""
