"""The extension by which mutabot finds this package's middlewares: ROS 1 and ROS 2."""

from mutabot.api.faults import Extension

EXTENSION = Extension(
    interface=2,
    middlewares={
        "rclpy": "mutabot_ros.ros2",
        "rospy": "mutabot_ros.ros1",
        "actionlib": "mutabot_ros.ros1_actions",
        "tf2_ros": "mutabot_ros.tf",
    },
    environments={"ros": "mutabot_ros.environment"},
    simulations={"ros2": "mutabot_ros.simulation.campaign:Ros2Simulation"},
    tables={"ros": "mutabot_ros.simulation.campaign:RosTable"},
    failures={"needs-real-ros": "ros_in_process:NeedsRealRos"},
    futures={"rclpy.task.Future": "rclpy.task:Future"},
    libraries={
        "rospy": ("get_param", "get_param_cached", "wait_for_message"),
        "rclpy": ("wait_for_message",),
        **dict.fromkeys(
            ("actionlib", "tf", "tf2_ros", "tf2_py", "genpy", "rosgraph", "rosparam", "roslib", "rosnode",
             "rosservice", "rostopic", "message_filters", "builtin_interfaces", "rosidl_runtime_py",
             "rcl_interfaces", "ament_index_python", "launch", "launch_ros", "*_msgs", "*_srvs",
             "*_interfaces"),
            (),
        ),
    },
)  # fmt: skip
