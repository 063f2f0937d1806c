"""Runs campaigns over ROS 2 in one process (`ros_in_process`) instead of the real middleware."""
