"""Posts a model to a running arcslip and prints its path as it grows: a client in plain Python, to start from.

    python3 tests/clients/arcslip.py http://127.0.0.1:8080 model.json

Where the service asks for a token, it is taken from the environment: ARCSLIP_TOKEN.

One line an increment: its index, the load factor, and what happened there. Exit status 0 where the path was completed or
stopped, 1 where the job failed or was cancelled, 2 where the request was refused.

What a program over HTTP should do is here: a key with the request, so that sending it twice queues one job; waiting where
the service is full or away; and reading on after the last increment received where the stream breaks off.
"""

import http.client
import json
import os
import sys
import time
import urllib.error
import urllib.request
import uuid

# Seconds: between tries where the service does not say how long, until a silent connection counts as lost, and until a
# service that does not answer, or does not take the request, is given up.
PAUSE = 1.0
SILENCE = 60.0
PATIENCE = 600.0
# Answers after which the same request may succeed: full queue, full disk, service going down or away.
PASSING = {429, 502, 503, 504, 507}


class Refused(Exception):
    """An answer that no repetition mends; `problem` is its application/problem+json."""

    def __init__(self, problem):
        super().__init__(problem.get("detail") or problem.get("title"))
        self.problem = problem


class Arcslip:
    """A running service; `token` is sent as a bearer token where there is one."""

    def __init__(self, url, token=None):
        self.url = url.rstrip("/")
        self.headers = {"Authorization": f"Bearer {token}"} if token else {}

    def open(self, method, path, body=None, headers=()):
        """The answer to a request, once the service takes it; raises Refused where it never will, and what stood in the
        way where that lasts."""
        given_up = time.monotonic() + PATIENCE
        asked = urllib.request.Request(self.url + path, body, {**self.headers, **dict(headers)}, method=method)
        while True:
            try:
                return urllib.request.urlopen(asked, timeout=SILENCE)
            except urllib.error.HTTPError as answer:
                if answer.code not in PASSING or time.monotonic() > given_up:
                    raise Refused(json.loads(answer.read() or b"{}")) from None
                time.sleep(float(answer.headers.get("Retry-After") or PAUSE))
            except (OSError, http.client.HTTPException):
                # Nobody answers: it may be starting.
                if time.monotonic() > given_up:
                    raise
                time.sleep(PAUSE)

    def submit(self, request, key=None):
        """Queues a job (a dict, or JSON as bytes) and returns it. Safe to repeat with the same key."""
        body = request if isinstance(request, bytes) else json.dumps(request).encode()
        headers = {"Content-Type": "application/json", "Idempotency-Key": key or str(uuid.uuid4())}
        with self.open("POST", "/v1/jobs", body, headers) as answer:
            return json.load(answer)

    def job(self, identity):
        with self.open("GET", f"/v1/jobs/{identity}") as answer:
            return json.load(answer)

    def increments(self, identity):
        """Increments as they converge, each once, until the job has ended, through restarts of the service."""
        last = None
        while True:
            # Once it has ended, what a whole answer holds is all there is.
            ended = self.job(identity)["status"] not in ("queued", "running")
            headers = {"Accept": "application/x-ndjson"}
            if last is not None:
                headers["Last-Event-ID"] = str(last)
            try:
                with self.open("GET", f"/v1/jobs/{identity}/stream", headers=headers) as lines:
                    for line in lines:
                        if not line.strip():
                            continue  # The stream is alive, and has nothing new.
                        increment = json.loads(line)
                        last = increment["index"]
                        yield increment
            except (OSError, ValueError, http.client.HTTPException):
                # It broke off, perhaps within a line.
                continue
            if ended:
                return


def main(url, file):
    with open(file, "rb") as model:
        request = model.read()
    arcslip = Arcslip(url, os.environ.get("ARCSLIP_TOKEN"))
    try:
        job = arcslip.submit(request)
    except Refused as refused:
        print(refused, file=sys.stderr)
        for error in refused.problem.get("errors", []):
            print(f"{error['pointer']}: {error['detail']}", file=sys.stderr)
        return 2
    print(f"job {job['id']}", flush=True)
    for increment in arcslip.increments(job["id"]):
        point = increment["point"]
        print(increment["index"], increment["load_factor"], point["event"] or point["kind"], flush=True)
    job = arcslip.job(job["id"])
    print(job["status"], job.get("stop_reason") or "", job.get("error") or "")
    return 0 if job["status"] in ("completed", "stopped") else 1


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
