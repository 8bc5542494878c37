"""A client of a running service, on Python's standard library alone.

Each request is sent with a key, so that sending it twice queues one job; a service that is full or away is waited for; a
stream that breaks off is resumed after the last increment received.
"""

from __future__ import annotations

import difflib
import http.client
import json
import logging
import os
import socket
import ssl
import time
import urllib.error
import urllib.parse
import urllib.request
import uuid
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Union

from arcslip.errors import ArcslipError, JobFailed, Refused, Unreachable, invalid, text_of, warn
from arcslip.model import Model, as_request, plain
from arcslip.path import Path
from arcslip.progress import shown

#: Seconds between tries where the service does not say how long.
PAUSE = 1.0
#: Seconds of waiting after which the log says so.
MUTE = 2.0
#: How often a connection may break off while a request is sent, before that is what the service does with it.
MOST_BREAKS = 3
LOG = logging.getLogger("arcslip")
#: Seconds until a silent connection counts as lost; the service sends something every 15 s.
SILENCE = 60.0
#: Answers after which the same request may succeed: full queue, full disk, service going down or away.
PASSING = {429, 502, 503, 504, 507}
#: What has not ended.
UNDER_WAY = ("queued", "running")


class Client:
    """A service at `url`; `token` is sent as a bearer token, and is that of `ARCSLIP_TOKEN` unless given.

    `patience`: seconds after which a service that does not answer, or does not take a request, is given up.
    """

    def __init__(self, url: str = "http://127.0.0.1:8080", token: Optional[str] = None, patience: float = 600.0):
        self.url = url.rstrip("/")
        address = urllib.parse.urlsplit(self.url)
        if address.scheme not in ("http", "https") or not address.hostname:
            raise ValueError(f"an address such as http://127.0.0.1:8080 is expected; found {url!r}")
        self.patience = patience
        token = (token or os.environ.get("ARCSLIP_TOKEN") or "").strip()
        if not (token.isascii() and token.isprintable()):
            raise ValueError("the token has characters that no token has")
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}

    # Jobs -------------------------------------------------------------------------------------------------------------

    def submit(self, model: Union[Model, Mapping[str, Any]], *, key: Optional[str] = None, **analysis: Any) -> "Job":
        """Queues a job; `analysis` has settings, such as `max_increments=500`. Safe to repeat with the same `key`."""
        request = as_request(model, analysis)
        record = self.post("/v1/jobs", request, key)
        warn(warnings_of(record.get("plan") or {}))
        return Job(self, record, request)

    def check(self, model: Union[Model, Mapping[str, Any]], **analysis: Any) -> Dict[str, Any]:
        """The plan of a model: its scales, what it does not need, and warnings. Nothing is queued."""
        return self.post("/v1/jobs?validate=true", as_request(model, analysis))

    def solve(self, model: Union[Model, Mapping[str, Any]], *, progress: bool = False, **analysis: Any) -> Path:
        """Queues a job and waits for its path; `progress` shows a bar (tqdm)."""
        return self.submit(model, **analysis).path(progress=progress)

    def explore(
        self, model: Union[Model, Mapping[str, Any]], depth: int = 1, max_jobs: int = 100, **analysis: Any
    ) -> "Job":
        """Queues a job whose directions not taken are followed by jobs of their own, `depth` times in turn;
        `Job.branches` lists those."""
        return self.submit(model, explore={"depth": depth, "max_jobs": max_jobs}, **analysis)

    def job(self, identity: str) -> "Job":
        """A job by its `id`."""
        return Job(self, self.get(f"/v1/jobs/{identity}"))

    def jobs(self, **filters: Any) -> Iterator["Job"]:
        """Jobs, newest first; filtered by `status`, `parent` or `sweep`, the last two as `id` or as they are."""
        filters = {name: value.id if isinstance(value, Resource) else value for name, value in filters.items()}
        return (Job(self, found) for found in self._pages("/v1/jobs", "jobs", filters))

    def scene(self, name: str) -> Dict[str, Any]:
        """The request of a built-in scene."""
        return self.get(f"/v1/scenes/{urllib.parse.quote(name)}")

    # Sweeps and studies -----------------------------------------------------------------------------------------------

    def sweep(
        self,
        model: Union[Model, Mapping[str, Any]],
        replace: Mapping[str, Sequence[Any]],
        *,
        combine: str = "grid",
        responses: Optional[Mapping[str, Mapping[str, Any]]] = None,
        refine: int = 0,
        key: Optional[str] = None,
        **analysis: Any,
    ) -> "Sweep":
        """Queues a path for each combination of values at JSON pointers, such as
        `{"/model/contacts/0/friction": [0.1, 0.3]}`; a step `*` stands for every item. `combine` is `"grid"`, each value
        with each, or `"list"`, the first of each, the second of each and so on. `responses` are told of each path, such as
        `{"tip at limit": {"value": "tip.x", "at": "first_limit"}}`. `refine` adds so many runs at most, where the first
        response changes most between two values of the only parameter."""
        near = difflib.get_close_matches("responses", [name for name in analysis if name != "record"], 1, 0.8)
        if near:
            raise TypeError(f"{near[0]!r} is no member of the analysis; did you mean 'responses'?")
        request = as_request(model, analysis)
        for pointer, own in replace.items():
            if isinstance(own, (str, bytes, Mapping)) or not hasattr(own, "__iter__"):
                raise TypeError(f"{pointer}: a list or an array of values is expected, found {own!r}")
        values = {pointer: plain(list(own) if not hasattr(own, "tolist") else own) for pointer, own in replace.items()}
        request["sweep"] = {"replace": values, "combine": combine, **({"responses": plain(responses)} if responses else {})}
        if refine:
            request["sweep"]["refine"] = refine
        record = self.post("/v1/sweeps", request, key)
        warn(warnings_of(record))
        return Sweep(self, record)

    def study(
        self, model: Union[Model, Mapping[str, Any]], settings: Optional[Mapping[str, Any]] = None,
        *, key: Optional[str] = None, **analysis: Any
    ) -> "Study":
        """Queues a study of error against run time; `settings` are those of the request's member `study`."""
        request = as_request(model, analysis)
        request["study"] = plain(settings or {})
        return Study(self, self.post("/v1/studies", request, key))

    def curve(
        self, model: Union[Model, Mapping[str, Any]], parameter: str, values: Sequence[float], *, step: Optional[float] = None,
        limit_point: Optional[int] = None, increment: Optional[int] = None, key: Optional[str] = None, **analysis: Any
    ) -> "Curve":
        """Queues a curve: a limit point of the model's path as the number at a JSON pointer, such as
        `/model/contacts/0/friction`, varies between two values, with the model's own among them. `limit_point` counts from
        1 along the path, without either it is the first one; `increment` is that of a limit point, of a smooth bifurcation
        point or of a contact change."""
        request = as_request(model, analysis)
        request["curve"] = curve_settings(parameter, values, step, limit_point, increment)
        return Curve(self, self.post("/v1/curves", request, key))

    # Calls ------------------------------------------------------------------------------------------------------------

    def get(self, path: str) -> Any:
        """The JSON that a call answers."""
        return json.loads(self.read("GET", path))

    def post(self, path: str, request: Any, key: Optional[str] = None) -> Any:
        """The JSON that a posted request answers; mistakes in it raise `InvalidModel`."""
        headers = {"Content-Type": "application/json", "Idempotency-Key": key or str(uuid.uuid4())}
        try:
            return json.loads(self.read("POST", path, text_of(request).encode(), headers))
        except Refused as refused:
            if refused.status == 422 and refused.problem.get("errors"):
                raise invalid(request, refused.problem["errors"]) from None
            raise

    def read(self, method: str, path: str, body: Optional[bytes] = None, headers: Mapping[str, str] = {}) -> bytes:
        """The bytes that a call answers. One that breaks off is asked for again."""
        given_up = time.monotonic() + self.patience
        while True:
            try:
                with self.open(method, path, body, headers) as answer:
                    return answer.read()
            except Unreachable:
                raise
            except (OSError, http.client.HTTPException) as error:
                if time.monotonic() > given_up:
                    raise Unreachable(f"the answer of {self.url}{path} breaks off: {error}") from error
                time.sleep(PAUSE)

    def open(self, method: str, path: str, body: Optional[bytes] = None, headers: Mapping[str, str] = {}) -> Any:
        """The answer to a call, once the service takes it. Raises `Refused` where it never will, and `Unreachable` where
        no service answers, or not for as long as `patience` says."""
        begun = time.monotonic()
        said, breaks = False, 0
        asked = urllib.request.Request(self.url + path, body, {**self._headers, **headers}, method=method)
        while True:
            try:
                return urllib.request.urlopen(asked, timeout=SILENCE)
            except urllib.error.HTTPError as answer:
                why = problem_of(answer.read())
                if answer.code not in PASSING or time.monotonic() > begun + self.patience:
                    raise Refused(answer.code, why) from None
                reason, pause = str(why.get("detail") or answer.code), pause_of(answer.headers.get("Retry-After"))
            except (OSError, http.client.HTTPException) as error:
                cause = getattr(error, "reason", error)
                breaks += isinstance(cause, (BrokenPipeError, ConnectionResetError)) and body is not None
                if breaks >= MOST_BREAKS:
                    size = f"{len(body or b'') / 2**20:.1f} MiB"
                    raise Unreachable(f"{self.url} breaks off while a request of {size} is sent: too large?") from error
                # No service is there by this name, or with this certificate, however long one waits.
                if isinstance(cause, (socket.gaierror, ssl.SSLError, http.client.InvalidURL)):
                    raise Unreachable(f"{self.url}: {cause}") from error
                if time.monotonic() > begun + self.patience:
                    raise Unreachable(f"{self.url} does not answer: {cause}") from error
                # It may be starting.
                reason, pause = str(cause), PAUSE
            if not said and time.monotonic() > begun + MUTE:
                said = True
                LOG.warning("waiting for %s: %s", self.url, reason)
            time.sleep(pause)

    def _pages(self, path: str, member: str, filters: Mapping[str, Any]) -> Iterator[Dict[str, Any]]:
        asked = {name: value for name, value in filters.items() if value is not None}
        while True:
            page = self.get(f"{path}?{urllib.parse.urlencode(asked)}" if asked else path)
            yield from page[member]
            if page["next_cursor"] is None:
                return
            asked["cursor"] = page["next_cursor"]

    def __repr__(self) -> str:
        return f"<Client of {self.url}>"


def problem_of(text: bytes) -> Dict[str, Any]:
    try:
        problem = json.loads(text or b"{}")
    except ValueError:
        # Of a proxy.
        return {"detail": text.decode(errors="replace")[:500]}
    return problem if isinstance(problem, dict) else {"detail": str(problem)}


def warnings_of(record: Mapping[str, Any]) -> List[str]:
    return [f"{warning['pointer']}: {warning['detail']}" for warning in record.get("warnings") or []]


def pause_of(header: Optional[str]) -> float:
    try:
        return max(float(header or PAUSE), 0.0)
    except ValueError:
        # A date.
        return PAUSE


class Resource:
    """Something that a service works on: `record` is its state as it was last read."""

    folder = ""

    def __init__(self, client: Client, record: Dict[str, Any]):
        self.client, self.record = client, record

    @property
    def id(self) -> str:
        return self.record["id"]

    @property
    def address(self) -> str:
        return f"/v1/{self.folder}/{self.id}"

    def refresh(self) -> Dict[str, Any]:
        """Reads the state again."""
        self.record = self.client.get(self.address)
        return self.record

    @property
    def status(self) -> str:
        """`queued`, `running`, `completed`, `stopped`, `cancelled` or `failed`, read again unless it has ended."""
        if self.record["status"] in UNDER_WAY:
            self.refresh()
        return self.record["status"]

    def wait(self, every: float = 0.2) -> str:
        """Waits until it has ended; returns the status."""
        while self.status in UNDER_WAY:
            time.sleep(every)
            every = min(1.5 * every, 5.0)
        return self.status

    def cancel(self) -> None:
        """Stops it; what is stored stays."""
        self.client.read("POST", f"{self.address}/cancel")

    def delete(self) -> None:
        """Stops it and deletes what is stored."""
        self.client.read("DELETE", self.address)
        self.record = {**self.record, "status": "deleted"}

    def _pages_of_rows(self) -> Iterator[Dict[str, Any]]:
        after = ""
        while True:
            page = self.client.get(f"{self.address}/rows{after}")
            yield from page["rows"]
            if not page["rows"]:
                return
            after = f"?after={page['next_after']}"

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.id}: {self.record['status']}>"


class Job(Resource):
    """A job. Iterating over it gives its increments as they converge."""

    folder = "jobs"

    def __init__(self, client: Client, record: Dict[str, Any], request: Optional[Dict[str, Any]] = None):
        super().__init__(client, record)
        self._request = request

    @property
    def request(self) -> Dict[str, Any]:
        """The request; of a job that follows another, that of the other."""
        if self._request is None:
            self._request = self.client.get(f"{self.address}/request")
        return self._request

    def increments(self, after: Optional[int] = None) -> Iterator[Dict[str, Any]]:
        """Increments as they converge, each once, until the job has ended, through restarts of the service. `after`:
        the index of the last one that is known already."""
        last = after
        while True:
            # Once it has ended, what a whole answer holds is all there is.
            ended = self.status not in UNDER_WAY
            headers = {"Accept": "application/x-ndjson"}
            if last is not None:
                headers["Last-Event-ID"] = str(last)
            try:
                with self.client.open("GET", f"{self.address}/stream", headers=headers) as lines:
                    for line in lines:
                        if not line.strip():
                            continue  # The stream is alive, and has nothing new.
                        increment = json.loads(line)
                        last = increment["index"]
                        yield increment
            except ArcslipError:
                raise
            except (OSError, ValueError, http.client.HTTPException):
                # It broke off, perhaps within a line.
                continue
            if ended:
                return

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        return self.increments()

    def path(self, progress: bool = False) -> Path:
        """The whole path, once the job has ended. Raises `JobFailed` where it failed; its increments can still be
        iterated over."""
        most = self.record.get("progress", {}).get("max_increments")
        increments = list(shown(self.increments(), most, progress))
        self.refresh()
        if self.record["status"] == "failed":
            raise JobFailed(f"job {self.id} failed: {self.record.get('error')}")
        path = Path(self.request, increments, self.record.get("report"), self.record.get("stop_reason"))
        parent = self.record.get("parent")
        if parent:
            path.branch = f"direction {parent['direction']} at increment {parent['increment']} of job {parent['job']}"
        return path

    def follow(
        self, increment: int, direction: int, max_increments: Optional[int] = None, *, key: Optional[str] = None
    ) -> "Job":
        """Queues a job along a direction of an increment, by its place in the increment's `directions`."""
        request = {"increment": int(increment), "direction": int(direction)}
        if max_increments is not None:
            request["max_increments"] = int(max_increments)
        return Job(self.client, self.client.post(f"{self.address}/follow", request, key), self.request)

    def limit_curve(
        self, parameter: str, values: Sequence[float], *, step: Optional[float] = None, limit_point: Optional[int] = None,
        increment: Optional[int] = None, key: Optional[str] = None
    ) -> "Curve":
        """Queues a curve of a limit point or another point of this job; see `Client.curve`."""
        request = curve_settings(parameter, values, step, limit_point, increment)
        return Curve(self.client, self.client.post(f"{self.address}/continue", request, key))

    def branches(self) -> List["Job"]:
        """The jobs that follow directions of this one."""
        return list(self.client.jobs(parent=self.id))

    def download(self, name: str) -> bytes:
        """The bytes of a file with all increments, once the job has ended: `path.csv`, or `results.pvd` or
        `results.parquet`, which are zip files."""
        self.wait()
        return self.client.read("GET", f"{self.address}/{name}")


class Sweep(Resource):
    """A sweep: one path for each combination of values."""

    folder = "sweeps"

    def rows(self) -> List[Dict[str, Any]]:
        """The runs that have ended, in their order: `values`, `stop_reason`, `first_limit`, `responses` and so on."""
        return sorted(self._pages_of_rows(), key=lambda row: row["run"])

    def to_frame(self) -> Any:
        """The runs as a table of pandas, with a column for each parameter and each response, and the first limit point of each
        path in `limit.load_factor` and the other columns `limit.`; numbers are not-a-number where there is none."""
        import pandas

        pointers = [parameter["pointer"] for parameter in self.refresh()["parameters"]]
        limits = ("kind", "stage", "load_factor", "arc_length", "increment")
        table = []
        for row in self.rows():
            limit = row.get("first_limit") or {}
            values = dict(zip(pointers, row["values"]))
            own = {name: row.get(name) for name in ("run", "job", "status", "stop_reason", "last_index")}
            told = row.get("responses") or {}
            table.append({**own, **values, **told, **{f"limit.{name}": limit.get(name) for name in limits}})
        frame = pandas.DataFrame(table)
        frame.attrs["units"] = self.record.get("response_units") or {}
        numbers = ["limit.load_factor", "limit.arc_length", "limit.increment"]
        return frame.astype({name: float for name in numbers if name in frame})

    def jobs(self) -> List[Job]:
        """The runs as jobs."""
        return list(self.client.jobs(sweep=self.id))


def curve_settings(
    parameter: str, values: Sequence[float], step: Optional[float], limit_point: Optional[int], increment: Optional[int]
) -> Dict[str, Any]:
    """What a curve follows, as a request has it."""
    given = {"step": step, "limit_point": limit_point, "increment": increment}
    optional = {name: plain(value) for name, value in given.items() if value is not None}
    return {"parameter": parameter, "range": [float(value) for value in values], **optional}


class Curve(Resource):
    """A curve of limit points or others over a parameter of the model."""

    folder = "curves"

    def rows(self) -> List[Dict[str, Any]]:
        """The points found so far, in order along the curve: `value`, `load_factor`, `kind`, `displacements`, `event` and so on.
        Raises `JobFailed` where there is no such point, or it cannot be followed."""
        found = sorted(self._pages_of_rows(), key=lambda row: row["place"])
        if not found and self.status not in UNDER_WAY and self.record.get("error"):
            raise JobFailed(f"curve {self.id} has no point: {self.record['error']}")
        return found

    def to_frame(self) -> Any:
        """The points as a table of pandas: `value`, `load_factor`, `kind`, `codimension_two`, `event`, and the displacements in
        columns such as `tip.x`. `off_path` marks the points past one that a path of its own does not have."""
        import pandas

        table = []
        is_plane = self.refresh()["plan"]["dimension"] == 2
        axes = ("x", "y", "rz") if is_plane else ("x", "y", "z", "rx", "ry", "rz")
        rows, report = self.rows(), self.report()
        first, last = (report.get(name) for name in ("off_path_from", "off_path_to"))
        for row in rows:
            own = {name: row.get(name) for name in ("index", "value", "load_factor", "kind", "stage", "event")}
            moved = {
                f"{node}.{axis}": component
                for node, components in row["displacements"].items()
                for axis, component in zip(axes, components)
            }
            off = (first is not None and row["place"] >= first) or (last is not None and row["place"] <= last)
            table.append({**own, "codimension_two": bool(row.get("codimension_two")), "off_path": off, **moved})
        return pandas.DataFrame(table)

    def report(self) -> Dict[str, Any]:
        """How it ended in both directions, once it has."""
        return self.refresh().get("report") or {}


class Study(Resource):
    """A study of error against run time."""

    folder = "studies"

    def report(self) -> Dict[str, Any]:
        """The rows and references so far."""
        return self.refresh().get("report") or {}
