class Gripper:
    def __init__(self, address):
        raise ConnectionError(address)

    def open_to(self, width):
        """Not reached in tests."""

    def close(self):
        """Not reached in tests."""
