"""Behaviours of rclpy, each recorded over a real middleware and over a simulated one, and compared."""
