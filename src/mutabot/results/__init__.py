"""Analysis: scores, kill rates and why survivors survived, from what a journal holds."""
