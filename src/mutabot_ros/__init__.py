"""Interception of robot middlewares (ROS 1 and ROS 2): messages, calls and parameters, one file each."""
