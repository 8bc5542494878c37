#!/usr/bin/env python3
"""Checks README.md and the manual (src/manual/*.md): commands run, outputs are compared, links lead somewhere.

    python3 tests/documentation.py [--program PATH] [--only CHAPTER]...

It needs the built program, bash and curl; blocks marked `sh server` need port 8080. One line is printed for each chapter;
the exit status is 1 if there are mistakes, and all of them are listed. The marks of blocks:

    sh             runs in a folder of the chapter's own; blocks of a chapter share one shell; every command succeeds
    sh status=N    runs, too; its last command ends with status N
    sh server      runs, too; a service with the built-in scenes listens on http://127.0.0.1:8080
    sh shown       is not run
    text           the output of the `sh` block before it
    text shown     is not compared
    json model     a request that the program accepts: `check`, or `sweep`, `study` or `continue` where it has their member
    json model F   that, too; the commands find it as the file F
    json, toml, python    can be read
    javascript     is not checked
    rust           is a test of `cargo test --doc`; only in the chapter of the library
"""

import argparse
import dataclasses
import datetime
import difflib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
MANUAL = ROOT / "src/manual"
# Where the pictures of the manual stand; the program serves those.
PICTURES = [ROOT / "src/check/scenes/pictures", ROOT / "src/service/http/dashboard/pictures"]
# Pictures without times in them: the program draws them to the byte.
DRAWN = {
    "arch-on-rough-floor.svg": ["solve", ROOT / "tests/solver/models/arch-on-rough-floor.json", "--against", "crown.y"],
    "one-bar-truss.svg": ["solve", "one-bar-truss"],
    "three-snapping-bars.svg": ["solve", "three-snapping-bars"],
    "arch-type-truss-sweep.svg": [
        "sweep", "arch-type-truss",
        "--replace", "/model/contacts/0/friction=0,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9,1,1.1,1.2,1.3,1.4,1.5",
    ],
}
# Addresses of the service that a chapter may link to.
SERVED = {"/", "/docs", "/openapi.json", "/manual"}
PORT = 8080
SERVICE = f"http://127.0.0.1:{PORT}"
README_LINES = 200
LINE_LENGTH = 120
LIBRARY = "library"
# Seconds that a chapter's commands, and the start of the service, may take.
CHAPTER_TIME = 900
START_TIME = 300

FENCE = re.compile(r"^( *)(`{3,}|~{3,})(.*)$")
RUN = re.compile(r"^sh( server)?(?: status=(\d+))?$")
MODEL = re.compile(r"^json model(?: ([\w-]+\.json))?$")
OTHER_MARKS = {"sh shown", "text", "text shown", "json", "toml", "python", "javascript", "rust"}
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
HEADING = re.compile(r"^(#{1,6}) +(.*?)(?: +#+)?$")
MEASURED = re.compile(r"Measured by `([^`]+)`, ([^`]+?), (\d{4}-\d\d-\d\d)\.")
TARGET = re.compile(r"--(bench|test) ([\w-]+)")
# What measures.
PROGRAMS = {"arcslip", "bash", "cargo", "curl", "ls", "pgbench", "python3", "taskset", "wc"}
FILE = re.compile(r"(?<![\w./~-])((?:src|tests|openapi|migrations)/[\w./-]*[\w/])")


@dataclasses.dataclass
class Block:
    mark: str
    line: int  # of its fence
    lines: list

    @property
    def text(self):
        return "".join(line + "\n" for line in self.lines)


class Chapter:
    """A file: its prose as (number, line), its blocks, and the mistakes found in it."""

    def __init__(self, path):
        self.path = path
        self.name = path.stem
        self.mistakes = []
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.prose, self.blocks = [], []
        fence = None
        for number, line in enumerate(self.lines, 1):
            found = FENCE.match(line)
            if fence is None and found:
                fence = found[2]
                self.blocks.append(Block(found[3].strip(), number, []))
                if found[1] or fence[0] == "~":
                    self.mistake(number, "a block begins with ``` in the first column")
            elif fence is not None and found and found[2].startswith(fence) and not found[3].strip():
                fence = None
            elif fence is not None:
                self.blocks[-1].lines.append(line)
            else:
                self.prose.append((number, line))
        if fence is not None:
            self.mistake(self.blocks[-1].line, "the block has no end")
        self.anchors = set(anchors(line for _, line in self.prose))

    def mistake(self, line, text):
        self.mistakes.append(f"{self.path.relative_to(ROOT)}:{line}: {text}")


def anchors(lines):
    """The anchors of headings as GitHub names them."""
    seen = {}
    for line in lines:
        heading = HEADING.match(line)
        if not heading:
            continue
        text = LINK.sub(lambda link: link[2], heading[2])
        name = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
        count = seen.get(name, 0)
        seen[name] = count + 1
        yield f"{name}-{count}" if count else name


def check_form(chapter):
    if not chapter.lines or not re.match(r"^# \S", chapter.lines[0]):
        chapter.mistake(1, "the first line is not `# Title`")
    if chapter.name == "README" and len(chapter.lines) > README_LINES:
        chapter.mistake(len(chapter.lines), f"{len(chapter.lines)} lines, at most {README_LINES}")
    for number, line in chapter.prose:
        is_excused = line.startswith(("|", "Measured by")) or "](" in line or "://" in line
        if len(line) > LINE_LENGTH and not is_excused:
            chapter.mistake(number, f"{len(line)} characters, at most {LINE_LENGTH}")
        if line.startswith(">"):
            chapter.mistake(number, "a line that begins with > is a quotation")
        if re.search(r"<[A-Za-z/!]", re.sub(r"`[^`]*`|<(https?://|mailto:)[^>]*>", "", line)):
            chapter.mistake(number, "HTML; put it into `...`")
        if re.match(r"^(\t| {4,})\S", line) and not re.match(r"^\s*([-*|]|\d+\.) ", line):
            before = chapter.lines[number - 2].strip() if number > 1 else ""
            if not before:
                chapter.mistake(number, "an indented block has no mark: use ```")
    for block in chapter.blocks:
        if not RUN.match(block.mark) and not MODEL.match(block.mark) and block.mark not in OTHER_MARKS:
            chapter.mistake(block.line, f"unknown mark of a block: `{block.mark}`")
        if block.mark == "rust" and chapter.name != LIBRARY:
            chapter.mistake(block.line, f"Rust stands in the chapter `{LIBRARY}`, where it is tested")


def check_links(chapter, chapters):
    for number, line in chapter.prose:
        for is_picture, text, target in LINK.findall(re.sub(r"`[^`]*`", "`", line)):
            if re.match(r"^(https?|mailto):", target):
                continue
            if not text.strip():
                chapter.mistake(number, f"the link to {target} has no text")
            path, _, anchor = target.partition("#")
            if path.startswith("/"):
                if path not in SERVED or chapter.name == "README":
                    chapter.mistake(number, f"{target}: no such page")
                continue
            file = (chapter.path.parent / path).resolve() if path else chapter.path
            if not file.is_file():
                chapter.mistake(number, f"{target}: no such file")
            elif file.suffix == ".md":
                other = chapters.get(file)
                if other is None:
                    chapter.mistake(number, f"{target}: neither the README nor a chapter")
                elif anchor and anchor not in other.anchors:
                    chapter.mistake(number, f"{target}: no such heading")
            elif is_picture and file.parent not in PICTURES:
                chapter.mistake(number, f"{target}: pictures stand in " + " and ".join(map(shown, PICTURES)))
            elif not is_picture and chapter.name != "README":
                chapter.mistake(number, f"{target}: chapters link to chapters only")


def shown(path):
    return str(path.relative_to(ROOT))


def check_named(chapter, manifest):
    """What is named exists: benches, tests, files."""
    targets = {kind: {entry["name"] for entry in manifest[kind]} for kind in ("bench", "test")}
    for number, line in enumerate(chapter.lines, 1):
        for kind, name in TARGET.findall(line):
            if name not in targets[kind]:
                chapter.mistake(number, f"Cargo.toml has no {kind} `{name}`")
        for code in re.findall(r"`([^`]+)`", line):
            for path in FILE.findall(code):
                if not (ROOT / path).exists():
                    chapter.mistake(number, f"{path}: no such file")


def check_measured(chapter):
    """Figures carry command, machine and date."""
    paragraph, begin = [], 0
    for number, line in [*chapter.prose, (len(chapter.lines) + 1, "")]:
        if line.strip() and (not paragraph or number == begin + len(paragraph)):
            begin = begin if paragraph else number
            paragraph.append(line.strip())
            continue
        text = " ".join(paragraph)
        found = MEASURED.findall(text)
        if text.count("Measured by") != len(found):
            chapter.mistake(begin, "expected: Measured by `COMMAND`, MACHINE, YYYY-MM-DD.")
        for command, _, date in found:
            try:
                if datetime.date.fromisoformat(date) > datetime.date.today() + datetime.timedelta(days=1):
                    raise ValueError
            except ValueError:
                chapter.mistake(begin, f"{date} is no day that has been")
            words = [word for word in command.split() if "=" not in word]
            if not words or words[0] not in PROGRAMS:
                chapter.mistake(begin, f"`{command}` is no command")
        paragraph, begin = ([line.strip()], number) if line.strip() else ([], 0)


def check_data(chapter, program):
    for block in chapter.blocks:
        data = None
        try:
            if block.mark == "json" or MODEL.match(block.mark):
                data = json.loads(block.text)
            elif block.mark == "toml":
                tomllib.loads(block.text)
            elif block.mark == "python":
                compile(block.text, f"{chapter.name}:{block.line}", "exec")
        except (ValueError, SyntaxError) as error:
            chapter.mistake(block.line, f"cannot be read: {error}")
            continue
        if MODEL.match(block.mark):
            commands = {"sweep": "sweep", "study": "study", "curve": "continue"}
            command = next((command for member, command in commands.items() if member in data), "check")
            checked = subprocess.run([program, command, "-"], input=block.text, text=True, capture_output=True)
            if checked.returncode != 0:
                chapter.mistake(block.line, f"is no model:\n{checked.stderr or checked.stdout}")


def environment(program, folder):
    """What the commands of a chapter find: the program, and nothing of the caller's settings."""
    binaries = folder / "bin"
    binaries.mkdir()
    (binaries / "arcslip").symlink_to(program)
    taken = {name: value for name, value in os.environ.items() if not name.startswith(("ARCSLIP_", "PG"))}
    # The Python package as if it were installed.
    package = str(ROOT / "openapi/python/src")
    path = f"{binaries}:{os.environ['PATH']}"
    return {**taken, "PATH": path, "PYTHONPATH": package, "HOME": str(folder), "LC_ALL": "C.UTF-8"}


def end_group(process):
    """Ends a process that was started in a group of its own, and what it left at work."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
        except ProcessLookupError:
            return
        if number == signal.SIGTERM:
            time.sleep(0.2)


def run_blocks(chapter, program):
    """Runs the `sh` blocks in one shell and compares what `text` blocks say; answers how many of each."""
    runs = [block for block in chapter.blocks if RUN.match(block.mark)]
    compared = 0
    if not runs:
        return 0, compared
    with tempfile.TemporaryDirectory(prefix="arcslip-documentation-") as name:
        folder = pathlib.Path(name)
        work = folder / "work"
        work.mkdir()
        if chapter.name == "README":
            # Its commands are those of a reader in the repository.
            (work / "tests").symlink_to(ROOT / "tests")
        for block in chapter.blocks:
            model = MODEL.match(block.mark)
            if model and model[1]:
                (work / model[1]).write_text(block.text, encoding="utf-8")
        script = ["set -uo pipefail"]
        for number, block in enumerate(runs):
            (folder / f"{number}.sh").write_text(block.text, encoding="utf-8")
            # Where a status is expected, the shell goes on after it.
            mode = "+e" if RUN.match(block.mark)[2] else "-e"
            files = {kind: folder / f"{number}.{kind}" for kind in ("sh", "out", "err", "status")}
            script += [
                f"set {mode}",
                f"source {files['sh']} > {files['out']} 2> {files['err']}",
                f"echo $? > {files['status']}",
            ]
        (folder / "all.sh").write_text("\n".join(script) + "\n", encoding="utf-8")
        shell = subprocess.Popen(
            ["bash", "--noprofile", "--norc", folder / "all.sh"], cwd=work, env=environment(program, folder),
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )
        try:
            shell.wait(CHAPTER_TIME)
        except subprocess.TimeoutExpired:
            chapter.mistake(1, f"the commands take more than {CHAPTER_TIME} s")
        finally:
            end_group(shell)
            shell.wait()
        for number, block in enumerate(runs):
            expected = int(RUN.match(block.mark)[2] or 0)
            found = folder / f"{number}.status"
            told = (folder / f"{number}.err")
            if not found.exists() or int(found.read_text()) != expected:
                status = found.read_text().strip() if found.exists() else shell.returncode
                said = told.read_text(errors="replace")[-2000:] if told.exists() else ""
                chapter.mistake(block.line, f"ended with status {status}, expected {expected}\n{said}".rstrip())
                if not found.exists():
                    chapter.mistake(block.line, "the blocks after it were not run")
                    break
            compared += compare(chapter, block, (folder / f"{number}.out").read_text(errors="replace"))
    return len(runs), compared


def compare(chapter, block, printed):
    """Compares an output with the `text` block that follows, if one does."""
    after = chapter.blocks[chapter.blocks.index(block) + 1:][:1]
    if not after or after[0].mark != "text":
        return 0
    expected = after[0].text
    if printed != expected:
        lines = difflib.unified_diff(
            expected.splitlines(), printed.splitlines(), "as written", "as printed", lineterm="", n=1
        )
        chapter.mistake(after[0].line, "another output:\n" + "\n".join(lines))
    return 1


def check_texts(chapter):
    """A `text` block that is compared with nothing says so."""
    for before, block in zip([None, *chapter.blocks], chapter.blocks):
        if block.mark == "text" and (before is None or not RUN.match(before.mark)):
            chapter.mistake(block.line, "no block that is run stands before it; `text shown` is not compared")


class Service:
    """`arcslip serve --demo` in a folder of its own, ready once its jobs have ended."""

    def __init__(self, program):
        with socket.socket() as port:
            port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                port.bind(("127.0.0.1", PORT))
            except OSError:
                sys.exit(f"port {PORT} is taken")
        self.folder = tempfile.TemporaryDirectory(prefix="arcslip-documentation-service-")
        folder = pathlib.Path(self.folder.name)
        self.log = folder / "log"
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                ["arcslip", "serve", "--demo"], cwd=folder, env=environment(program, folder),
                executable=program, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
            )
        end = time.monotonic() + START_TIME
        while not self.is_ready():
            if self.process.poll() is not None or time.monotonic() > end:
                log = self.log.read_text(errors="replace")
                self.end()
                sys.exit(f"the service does not start:\n{log}")
            time.sleep(0.2)

    def is_ready(self):
        try:
            with urllib.request.urlopen(f"{SERVICE}/readyz", timeout=5):
                pass
            with urllib.request.urlopen(f"{SERVICE}/v1/jobs?limit=100", timeout=5) as answer:
                jobs = json.load(answer)["jobs"]
            return bool(jobs) and all(job["status"] not in ("queued", "running") for job in jobs)
        except OSError:
            return False

    def end(self):
        """Ends it; whether it ended in good order."""
        if self.process.poll() is None:
            self.process.terminate()
        try:
            status = self.process.wait(20)
        except subprocess.TimeoutExpired:
            status = None
        end_group(self.process)
        self.folder.cleanup()
        return status == 0


def check_pictures(program):
    """Answers what is wrong with the pictures that the program draws to the byte."""
    mistakes = []
    with tempfile.TemporaryDirectory(prefix="arcslip-documentation-") as folder:
        for name, command in DRAWN.items():
            drawn = pathlib.Path(folder) / name
            out = ["--out", "/dev/null", "--plot", drawn]
            done = subprocess.run([program, *command, *out], capture_output=True, text=True)
            # A path that stops, as at a mechanism, ends with 1.
            if done.returncode not in (0, 1) or not drawn.exists():
                mistakes.append(f"{name} cannot be drawn:\n{done.stderr}")
            elif drawn.read_bytes() != (PICTURES[0] / name).read_bytes():
                mistakes.append(f"{shown(PICTURES[0] / name)} is not what the program draws")
    return mistakes


def default_program():
    target = os.environ.get("CARGO_TARGET_DIR")
    if target is None:
        command = ["cargo", "metadata", "--format-version", "1", "--no-deps"]
        told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        target = json.loads(told.stdout)["target_directory"]
    return ROOT / target / "release/arcslip"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--program", type=pathlib.Path, help="the built program (default: that of the release build)")
    arguments.add_argument("--only", action="append", metavar="CHAPTER", help="README, or the name of a chapter")
    arguments = arguments.parse_args()
    program = (arguments.program or default_program()).resolve()
    if not program.is_file():
        sys.exit(f"{program} is not there: cargo build --release")
    if shutil.which("curl") is None:
        sys.exit("curl is needed")
    chapters = [Chapter(path) for path in [ROOT / "README.md", *sorted(MANUAL.glob("*.md"))]]
    by_path = {chapter.path: chapter for chapter in chapters}
    unknown = set(arguments.only or []) - {chapter.name for chapter in chapters}
    if unknown:
        sys.exit(f"no chapter {', '.join(sorted(unknown))}")
    chosen = [chapter for chapter in chapters if not arguments.only or chapter.name in arguments.only]
    manifest = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))

    needs_service = any("server" in block.mark.split() for chapter in chosen for block in chapter.blocks)
    service = Service(program) if needs_service else None
    general = []
    try:
        for chapter in chosen:
            check_form(chapter)
            check_links(chapter, by_path)
            check_named(chapter, manifest)
            check_measured(chapter)
            check_texts(chapter)
            check_data(chapter, program)
            began = time.monotonic()
            run, compared = run_blocks(chapter, program)
            state = f"{len(chapter.mistakes)} mistakes" if chapter.mistakes else "good"
            print(
                f"{chapter.name}: {state}; {len(chapter.lines)} lines, {run} blocks run in "
                f"{time.monotonic() - began:.1f} s, {compared} outputs compared", flush=True,
            )
        if not arguments.only:
            general = check_pictures(program)
    finally:
        if service is not None and not service.end():
            general.append("the service did not end in good order")
    mistakes = [mistake for chapter in chosen for mistake in chapter.mistakes] + general
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
