"""Sweeps of megabytes of values, listed: memory, and the wait of other calls meanwhile."""

import json
import threading

from server import Server, Watched, small_job

SWEEPS = 12
BYTES = 7_000_000
AT_ONCE = 8


def sweep():
    """Few runs and many bytes: each value is thousands of obstacles that no contact names."""
    request = small_job()
    floor = request["model"]["obstacles"]["floor"]
    value = {f"o{index:05}": {**floor, "point": [0, -1 - index]} for index in range(4_500)}
    values = [{"floor": floor, **value} for _ in range(BYTES // len(json.dumps(value)))]
    request["sweep"] = {"replace": {"/model/obstacles": values}}
    return request


def run():
    with Server("--workers", "0", "--max-queued", "100000") as server:
        body = json.dumps(sweep()).encode()
        for _ in range(SWEEPS):
            status, text, _ = server.call("POST", "/v1/sweeps", body, patience=600)
            if status != 202:
                raise RuntimeError(f"a sweep is refused: {status} {text[:500]}")
        before = server.memory()
        seconds = []

        def list_them():
            status, text, took = server.call("GET", "/v1/sweeps?limit=200")
            assert status == 200 and text.count(b'"id"') >= SWEEPS, (status, text[:200])
            seconds.append(took)

        with Watched(server) as watched:
            threads = [threading.Thread(target=list_them) for _ in range(AT_ONCE)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        yield f"{AT_ONCE} lists of {SWEEPS} sweeps of {len(body) / 1e6:.1f} MB, the slowest", max(seconds), 2, "s"
        yield "/healthz meanwhile, the slowest", watched.slowest, 0.5, "s"
        yield "more memory meanwhile", (watched.memory - before) / 1e6, 200, "MB"
        yield "server ended", float(not server.is_alive), 0, "times"
