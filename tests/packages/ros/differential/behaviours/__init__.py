"""The behaviours, as robot programs cause them: they know rclpy and nothing of Mutabot."""
