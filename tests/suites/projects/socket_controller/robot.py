"""A driver that talks to its controller by a socket, line by line."""

import re
import socket
import threading


class Controller:
    """A fake controller for tests: one client, one thread."""

    def __init__(self):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.x = 0.0
        self.open = False
        self.held = False
        self.farthest = 0.0
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        connection, _ = self.server.accept()
        with connection, connection.makefile("rw") as lines:
            for line in lines:
                lines.write(self.answer(line.strip()) + "\n")
                lines.flush()

    def answer(self, text):
        found = re.fullmatch(r"x/(-?[\d.]+)", text)
        if found:
            self.x = float(found[1])
            self.farthest = max(self.farthest, self.x)
        elif text in ("open", "close"):
            self.held = text == "close" and self.open and self.x == 120
            self.open = text == "open"
        elif text == "held?":
            return "yes" if self.held else "no"
        else:
            return "error"
        return "ok"


class Link:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.lines = self.socket.makefile("rw")

    def send(self, text):
        self.lines.write(text + "\n")
        self.lines.flush()
        return self.lines.readline().strip()

    def close(self):
        self.lines.close()
        self.socket.close()
