"""What all languages share: texts, tokens, trees, the machine that runs them, and the border to the cell."""
