"""ROS's middleware in Python: what stands in the place of rclpy's C extension."""
