"""Motion planning, from poses to joint setpoints: kinematics and trajectories."""
