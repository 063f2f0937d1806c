"""The middlewares of robots: where their messages, calls and parameters pass, one file each."""
