"""Frames, axes, joints and tools that are mistaken for others, one operator to a file."""
