"""Faults that robots have: each stands for a class of bugs that studies of robot software count."""
