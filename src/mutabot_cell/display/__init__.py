"""The cell's pictures, and the recordings that it gives mutabot during a test."""
