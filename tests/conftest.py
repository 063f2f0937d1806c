"""What all tests need."""

from __future__ import annotations

import signal


def pytest_configure() -> None:
    """Tests interrupt campaigns: a shell that starts us in the background has had interruptions ignored."""
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.default_int_handler)
