"""Which outcomes of earlier campaigns still hold: what they depend on, by content."""
