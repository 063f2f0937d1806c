"""Instrumented program text: alternatives compiled beside the original, and what is observed."""
