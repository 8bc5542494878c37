"""Sweeps whose checks last for minutes, and a job posted beside them; and after their clients have hung up."""

import json
import threading
import time

from server import Server, small_job

CONTACTS = 1_000
RUNS = 1_726


def sweep():
    """Small, with many runs of many contacts."""
    request = small_job()
    model = request["model"]
    for index in range(CONTACTS):
        name = f"n{index}"
        model["nodes"][name] = [index * 0.01, 0]
        model["elements"].append({"kind": "spring", "nodes": [name], "stiffness": [[1, 0], [0, 1]]})
        model["contacts"].append({"node": name, "obstacle": "floor", "friction": 0.3})
    values = [round(0.001 * (1 + run), 3) for run in range(RUNS)]
    request["sweep"] = {"replace": {"/model/stages/0/forces/tip/0": values}}
    return request


def run():
    with Server("--workers", "1") as server:
        body = json.dumps(sweep()).encode()
        clients = []
        for _ in range(3):
            connection = server.connect()
            head = f"POST /v1/sweeps?validate=true HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
            head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
            connection.sendall(head.encode() + body)
            clients.append(connection)
        time.sleep(1)
        seconds = []

        def post():
            status, text, took = server.call("POST", "/v1/jobs", small_job())
            if status != 202:
                raise RuntimeError(f"a job is refused: {status} {text[:500]}")
            seconds.append(took)

        for _ in range(3):
            post()
        yield f"a job posted beside three sweeps of {len(body) / 1e3:.0f} kB in check", max(seconds), 2, "s"
        threads = [threading.Thread(target=post) for _ in range(20)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        yield "20 jobs posted at once beside them, the slowest", max(seconds), 2, "s"
        for connection in clients:
            connection.close()
        began = time.monotonic()
        busy = lambda: processor_seconds(server)
        idle_since = None
        while time.monotonic() - began < 60:
            before = busy()
            time.sleep(0.2)
            if busy() - before < 0.05:
                idle_since = time.monotonic() - began
                break
        yield "checking goes on after the clients have gone", 60 if idle_since is None else idle_since, 3, "s"


def processor_seconds(server):
    with open(f"/proc/{server.process.pid}/stat") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100
