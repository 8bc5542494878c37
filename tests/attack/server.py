"""The program as a server of its own on this machine, and calls of it; nothing here leaves 127.0.0.1."""

import http.client
import json
import os
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time

PROGRAM = os.environ.get("ARCSLIP", os.path.join(os.path.dirname(__file__), "../../target/release/arcslip"))
PATIENCE = 120


class Server:
    """A server with a database of its own; it ends, and the database is dropped, with the `with` block."""

    def __init__(self, *arguments):
        self.arguments = arguments

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        database = os.path.join(self.folder.name, "jobs.db")
        command = [PROGRAM, "serve", "--listen", "127.0.0.1:0", "--database", database, *self.arguments]
        environment = {**os.environ, "RUST_LOG": "off"}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment)
        line = self.process.stdout.readline().decode()
        found = re.search(r"http://127\.0\.0\.1:(\d+)", line)
        if not found:
            self.__exit__()
            raise RuntimeError(f"the server does not start: {line!r}")
        self.port = int(found[1])
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.process.stdout.close()
        self.folder.cleanup()

    @property
    def is_alive(self):
        return self.process.poll() is None

    def memory(self, what="VmRSS"):
        """Bytes that the process has in memory; `VmHWM` the most that it had."""
        with open(f"/proc/{self.process.pid}/status") as status:
            found = re.search(rf"^{what}:\s+(\d+) kB", status.read(), re.MULTILINE)
        return int(found[1]) * 1024 if found else 0

    def call(self, method, path, body=None, patience=PATIENCE):
        """The status, the body as it came, and the seconds that they took."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=patience)
        headers = {}
        if body is not None:
            body = body if isinstance(body, bytes) else json.dumps(body).encode()
            headers["Content-Type"] = "application/json"
        began = time.monotonic()
        try:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            text = answer.read()
            return answer.status, text, time.monotonic() - began
        finally:
            connection.close()

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)


class Watched:
    """Asks for `/healthz` all the time while its block lasts, and keeps the longest wait and the most memory."""

    def __init__(self, server):
        self.server = server
        self.slowest = 0.0
        self.memory = 0
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._watch)

    def _watch(self):
        while not self.over.is_set():
            self.memory = max(self.memory, self.server.memory())
            _, _, seconds = self.server.call("GET", "/healthz")
            self.slowest = max(self.slowest, seconds)
            time.sleep(0.01)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def small_job(name="small"):
    """A job that is checked and solved at once."""
    return {
        "model": {
            "name": name,
            "dimension": 2,
            "nodes": {"pin": [0, 1], "tip": [-1.5, 0]},
            "supports": {"pin": ["x", "y"]},
            "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1.0}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "tip", "obstacle": "floor", "friction": 0.3}],
            "stages": [{"name": "push", "forces": {"tip": [1, 0]}}],
        },
        "analysis": {"max_increments": 20},
    }
