"""A structure whose factors are nearly full: it is refused before they are taken, and the server lives."""

import json

from models import expander
from server import Server


def run():
    with Server("--workers", "1") as server:
        body = json.dumps(expander(), separators=(",", ":")).encode()
        before = server.memory()
        for path in ["/v1/jobs?validate=true", "/v1/jobs"]:
            status, text, seconds = server.call("POST", path, body)
            detail = json.loads(text).get("errors", [{}])[0].get("detail", "")
            yield f"POST {path} of {len(body) / 1e6:.1f} MB answers {status}: {detail}", seconds, 5, "s"
            yield "not refused", float(status != 422), 0, "times"
        yield "more memory at the most", (server.memory("VmHWM") - before) / 1e6, 1000, "MB"
        status, _, seconds = server.call("GET", "/healthz")
        yield f"/healthz answers {status}", seconds, 0.5, "s"
        yield "server ended", float(not server.is_alive), 0, "times"
