"""A controller to talk to: takes URScript on port 30002 and answers with the robot's state, as a UR does.

Every process gets a loopback address of its own, so that mutants can run side by side.
"""

import os
import re
import socket
import struct
import threading
import time

PERIOD = 0.004
REACH = 0.85
NUMBERS = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


class Controller:
    def __init__(self):
        number = os.getpid()
        self.host = f"127.{number >> 16 & 255}.{number >> 8 & 255}.{number & 255 or 1}"
        self.joints, self.pose, self.tool = [0.0] * 6, [0.3, 0.2, 0.4, 0.0, 3.14, 0.0], None
        self.outputs, self.log = 0, []
        self._server = socket.create_server((self.host, 30002))
        self._open = True
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self):
        self._open = False
        self._thread.join()
        self._server.close()

    def _serve(self):
        client, _ = self._server.accept()
        client.settimeout(PERIOD)
        with client:
            while self._open:
                try:
                    client.sendall(self._state())
                    text = client.recv(65536).decode()
                except TimeoutError:
                    continue
                except OSError:
                    return
                if not text:
                    return
                for line in text.splitlines():
                    self._execute(line)
                time.sleep(PERIOD)

    def _execute(self, line):
        name, _, rest = line.partition("(")
        numbers = [float(number) for number in NUMBERS.findall(rest)]
        if name == "movej":
            self.joints = numbers[:6]
        elif name == "movel":
            if sum(part**2 for part in numbers[:3]) > REACH**2 or numbers[2] < 0:
                return  # out of reach: the robot stays where it is
            self.pose = numbers[:6]
        elif name == "set_tcp":
            self.tool = numbers[:6]
        elif match := re.match(r"digital_out\[(\d+)\]=(\w+)", line):
            bit = 1 << int(match[1])
            self.outputs = self.outputs | bit if match[2] == "True" else self.outputs & ~bit
            self.log.append((match[2] == "True", [round(part, 3) for part in self.pose[:3]]))

    def _state(self):
        mode = struct.pack("!iBQ???????Bd", 29, 0, 1, True, True, True, False, False, False, False, 0, 1.0)
        joints = b"".join(
            struct.pack("!dddffffB", position, position, 0, 0, 0, 0, 0, 0) for position in self.joints
        )
        parts = [
            mode,
            struct.pack("!iB", 5 + len(joints), 1) + joints,
            struct.pack("!iBdddddd", 53, 4, *self.pose),
            struct.pack("!iBhhbbddbbddffffBBb", 64, 3, 0, self.outputs, *[0] * 15),
        ]
        return struct.pack("!iB", 5 + sum(map(len, parts)), 16) + b"".join(parts)
