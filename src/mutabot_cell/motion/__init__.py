"""From poses to joints: kinematics and trajectories."""
