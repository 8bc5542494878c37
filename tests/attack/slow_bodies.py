"""Bodies that are announced and do not come, and a job posted beside them."""

import time

from server import Server, small_job

BODIES = 40
ANNOUNCED = 16 << 20


def run():
    with Server() as server:
        slow = []
        for _ in range(BODIES):
            connection = server.connect()
            head = f"POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nContent-Type: application/json\r\n"
            connection.sendall(f"{head}Content-Length: {ANNOUNCED}\r\n\r\n{{".encode())
            slow.append(connection)
        # Until all of them are being read.
        time.sleep(1)
        status, text, seconds = server.call("POST", "/v1/jobs", small_job())
        if status != 202:
            raise RuntimeError(f"a job is refused: {status} {text[:500]}")
        yield f"a job posted beside {BODIES} slow bodies", seconds, 2, "s"
        for connection in slow:
            connection.close()
