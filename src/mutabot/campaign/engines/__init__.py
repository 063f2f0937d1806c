"""The engines, which give mutants their outcomes, and all that makes these trustworthy."""
