"""The program text: alternatives compiled beside the original, and what is seen of both."""
