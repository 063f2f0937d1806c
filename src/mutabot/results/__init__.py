"""Analysis of a journal: scores, kill rates, and why survivors survived."""
