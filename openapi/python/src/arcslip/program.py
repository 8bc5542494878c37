"""Solves without a service: by the program `arcslip`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import threading
from typing import Any, Callable, Dict, List, Mapping, Optional, Union

from arcslip.errors import ArcslipError, ProgramFailed, ProgramNotFound, invalid, text_of, warn
from arcslip.model import Model, as_request
from arcslip.path import Path
from arcslip.progress import shown

BAD_INPUT = 2
#: How a line of the program begins that tells of a possible mistake.
WARNING = "warning: "


def find_program(program: Optional[str] = None) -> str:
    """The program: what is given, that of `ARCSLIP_PROGRAM`, or `arcslip` on the search path."""
    asked = program or os.environ.get("ARCSLIP_PROGRAM") or "arcslip"
    found = shutil.which(asked)
    if found is None:
        raise ProgramNotFound(
            f"the program {asked!r} is not found; put `arcslip` on the search path, name it in ARCSLIP_PROGRAM, "
            "or use `Client` with a running service"
        )
    return found


def solve(
    model: Union[Model, Mapping[str, Any]],
    *,
    progress: bool = False,
    each: Optional[Callable[[Dict[str, Any]], None]] = None,
    program: Optional[str] = None,
    **analysis: Any,
) -> Path:
    """The path of a model, or of a request as a dict; `analysis` has settings, such as `max_increments=500`.

    `each` is called with each increment as it converges; `progress` shows a bar (tqdm). Mistakes in the model raise
    `InvalidModel`, and what may be a mistake is told as a `ModelWarning`.
    """
    request = as_request(model, analysis)
    if "explore" in request.get("analysis", {}):
        raise ValueError("a service alone explores other directions: use `Client.explore`")
    text = text_of(request)
    command = [find_program(program), "solve", "-", "--mistakes", "json"]
    solver = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8"
    )
    asks, answers, words = solver.stdin, solver.stdout, solver.stderr
    assert asks is not None and answers is not None and words is not None, "they are pipes"
    said: List[str] = []
    # What it says is read beside, as a full pipe would hold it up.
    listener = threading.Thread(target=lambda: said.append(words.read()), daemon=True)
    listener.start()
    increments = []
    try:
        try:
            with asks:
                asks.write(text)
        except BrokenPipeError:
            # It has ended already, and says why.
            pass
        lines = (json.loads(line) for line in answers)
        for increment in shown(lines, request.get("analysis", {}).get("max_increments", 1000), progress):
            increments.append(increment)
            if each is not None:
                each(increment)
        status = solver.wait()
    except BaseException:
        solver.kill()
        raise
    finally:
        answers.close()
        solver.wait()
        listener.join()
        words.close()
    words_said = "".join(said)
    warn(line[len(WARNING):] for line in words_said.splitlines() if line.startswith(WARNING))
    return path_of(request, increments, status, words_said)


def export(path: Path, file: Union[str, "os.PathLike[str]"], program: Optional[str] = None) -> None:
    """Writes a path in the format that the extension of the file names."""
    option = "--plot" if os.fspath(file).lower().endswith((".svg", ".png")) else "--out"
    with tempfile.TemporaryDirectory() as folder:
        lines = os.path.join(folder, "path.ndjson")
        path.save(lines)
        command = [find_program(program), "export", "-", lines, option, os.path.abspath(file)]
        if path.branch and option == "--out":
            command += ["--branch", path.branch]
        asked = text_of(path.request)
        run = subprocess.run(command, input=asked, capture_output=True, text=True, encoding="utf-8")
    if run.returncode != 0:
        raise ProgramFailed(run.stderr.strip())


def path_of(request: Dict[str, Any], increments: List[Dict[str, Any]], status: int, said: str) -> Path:
    """The path, from the increments and the last words of the program."""
    lines = [line for line in said.splitlines() if line.strip()]
    last = lines[-1] if lines else ""
    if status == BAD_INPUT:
        try:
            errors = json.loads(last)["errors"]
        except (ValueError, KeyError, TypeError):
            raise ProgramFailed(said.strip()) from None
        raise invalid(request, errors)
    start = last.find("{")
    try:
        report = json.loads(last[start:]) if start >= 0 else None
    except ValueError:
        report = None
    if report is None:
        raise ProgramFailed(said.strip() or f"the program ended with status {status} and without a word")
    return Path(request, increments, report, report.get("stop_reason"))


def scene(name: str, *, program: Optional[str] = None) -> Dict[str, Any]:
    """The request of a built-in scene."""
    run = subprocess.run([find_program(program), "scenes", name], capture_output=True, text=True, encoding="utf-8")
    if run.returncode != 0:
        raise ArcslipError(run.stderr.strip())
    return json.loads(run.stdout)
