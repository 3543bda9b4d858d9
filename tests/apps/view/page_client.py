"""What a page says to `kdray view`, over a plain socket: the few lines of HTTP and WebSocket (RFC 6455) that it takes."""

import json
import os
import select
import socket
import struct
import time
import urllib.parse

PATIENCE = 600  # seconds: nothing is expected of how long anything takes, but what hangs has to end as a failure

VIEW_REQUEST = {
    "scene": 0, "camera": {"from": [2.1, 1.3, 1.7], "at": [0, 0, 0], "up": [0, 0, 1], "fov": 45, "ortho": 0},
    "width": 640, "height": 480, "depth": 5, "samples": "adaptive", "weight": -1, "headlight": 0, "channel": "",
    "mode": "auto", "traversal": "auto", "queues": 0,
}  # fmt: skip


class PageClient:
    """A page that has sent hello with its token, and then sends looks."""

    def __init__(self, address):
        url = urllib.parse.urlsplit(address)
        self.socket = socket.create_connection((url.hostname, url.port), PATIENCE)
        host = url.netloc
        self.socket.sendall(
            f"GET /socket HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\n"
            "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
        )
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self._fill(PATIENCE)
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        assert head.startswith(b"HTTP/1.1 101"), head
        self.number = 0
        self.send({"type": "hello", "token": url.fragment.split("=")[1]})

    def send(self, message):
        self._send(0x81, json.dumps(message).encode())

    def _send(self, first, text):
        mask = os.urandom(4)
        head = bytes([first]) + (bytes([0x80 | len(text)]) if len(text) < 126 else struct.pack(">BH", 0xFE, len(text)))
        self.socket.sendall(head + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(text)))

    def look(self, moving, **changes):
        self.number += 1
        self.send({"type": "look", "number": self.number, "moving": moving, "sight": {**VIEW_REQUEST, **changes}})

    def _fill(self, limit):
        if not select.select([self.socket], [], [], limit)[0]:
            raise TimeoutError("kdray says nothing")
        data = self.socket.recv(1 << 20)
        if not data:
            raise ConnectionError("kdray has closed the connection")
        self.buffer += data

    def receive(self, limit=PATIENCE):
        """The next message, of a frame its head (the rest is `picture`); frames are acknowledged."""
        end = time.monotonic() + limit
        while True:
            n, begin = (self.buffer[1] & 127, 2) if len(self.buffer) > 1 else (1 << 60, 2)
            if n == 126 and len(self.buffer) >= 4:
                n, begin = struct.unpack_from(">H", self.buffer, 2)[0], 4
            elif n == 127 and len(self.buffer) >= 10:
                n, begin = struct.unpack_from(">Q", self.buffer, 2)[0], 10
            if len(self.buffer) >= begin + n and begin + n < 1 << 59:
                first, data = self.buffer[0], self.buffer[begin : begin + n]
                self.buffer = self.buffer[begin + n :]
                if first & 15 in (1, 2):
                    self.opcode, self.message = first & 15, b""
                if first & 15 == 9:  # a ping: who doesn't answer is taken for gone
                    self._send(0x8A, data)
                if first & 15 <= 2:  # 1 and 2 begin a message, 0 goes on with it
                    self.message += data
                if first & 15 > 2 or not first & 0x80:
                    continue
                if self.opcode == 1:
                    return json.loads(self.message)
                begin = 4 + struct.unpack_from("<I", self.message)[0]
                head, self.picture = json.loads(self.message[4:begin]), self.message[begin:]
                self.send({"type": "shown", "frame": head["frame"]})
                return head
            self._fill(max(0.0, end - time.monotonic()))

    def receive_until(self, kind, limit=PATIENCE):
        """A message of this type, or a frame of this kind."""
        end = time.monotonic() + limit
        while True:
            message = self.receive(max(0.0, end - time.monotonic()))
            if kind in (message["type"], message.get("kind")):
                return message

    def close(self):
        self.socket.close()
