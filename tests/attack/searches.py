"""Searches that last: each is cancelled soon after it has begun and further on, and the worker takes the next job."""

import json
import time

from models import springs_on_floor
from server import Server, small_job

SEARCHES = [
    ("400 nodes in space", springs_on_floor(400, 3)),
    ("2,000 in space", springs_on_floor(2_000, 3)),
    ("5,000 in space", springs_on_floor(5_000, 3)),
    ("20,000 in the plane", springs_on_floor(20_000, 2)),
    ("900 in space by mpec", springs_on_floor(900, 3, "mpec")),
]
AFTER = [0.5, 4.0]


def posted(server, request):
    status, text, _ = server.call("POST", "/v1/jobs", request)
    if status != 202:
        raise RuntimeError(f"a job is refused: {status} {text[:500]}")
    return "/v1/jobs/" + json.loads(text)["id"]


def waited(server, job, is_so):
    """Seconds until it is so, and the job."""
    began = time.monotonic()
    while True:
        found = json.loads(server.call("GET", job)[1])
        if is_so(found["status"]):
            return time.monotonic() - began, found
        if time.monotonic() - began > 600:
            raise RuntimeError(f"still {found['status']}")
        time.sleep(0.01)


def has_ended(status):
    return status not in ("queued", "running")


def run():
    for name, request in SEARCHES:
        for after in AFTER:
            with Server("--workers", "1") as server:
                job = posted(server, request)
                following = posted(server, small_job())
                waited(server, job, lambda status: status != "queued")
                time.sleep(after)
                server.call("POST", job + "/cancel")
                cancelled, found = waited(server, job, has_ended)
                begun, _ = waited(server, following, lambda status: status != "queued")
                end = f"{found['status']} ({found.get('stop_reason')})"
                megabytes = server.memory("VmHWM") / 1e6
                yield f"{name}, cancelled {after} s after it began: {end}, at most {megabytes:.0f} MB", cancelled, 1, "s"
                yield "until the next job has begun", cancelled + begun, 2, "s"
