"""ROS's middleware in Python, which replaces rclpy's C extension."""
