"""The behaviours, as a robot program and its tests would cause them: they know rclpy and nothing of Mutabot."""
