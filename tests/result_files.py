#!/usr/bin/env python3
"""Reads the files of results with the programs they are for, and compares every value with the increments.

    bash tests/result_files.sh [--time]

Models: a tower in space on sloped footings, the built-in arch, and a row with springs; each as NDJSON, CSV, `.pvd` and
Parquet, from the command line and over HTTP. With `--time`: seconds for 10,000 increments of 600 nodes in each format.
Exit status 1 where a value differs.
"""

import argparse
import io
import json
import math
import pathlib
import re
import socket
import subprocess
import tempfile
import time
import urllib.request
import zipfile

import numpy
import pyarrow.parquet
import vtk
from vtk.util.numpy_support import vtk_to_numpy

STATUS = {"free": 0, "slip": 1, "stick": 2}
AXES = "xyz"


def tower(levels=15):
    """A tower of four legs on sloped footings with friction, four nodes a level, pushed at its top."""
    nodes, elements, corners = {}, [], [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    for level in range(levels):
        half = 2.0 - 1.5 * level / (levels - 1)
        for corner, (x, y) in enumerate(corners):
            nodes[f"n{level}_{corner}"] = [half * x, half * y, 1.0 * level]

    def bar(one, other):
        elements.append({"kind": "bar", "nodes": [one, other], "axial_stiffness": 1e4})

    for level in range(levels):
        for corner in range(4):
            after = (corner + 1) % 4
            if level > 0:
                bar(f"n{level - 1}_{corner}", f"n{level}_{corner}")
                bar(f"n{level - 1}_{corner}", f"n{level}_{after}")
                bar(f"n{level - 1}_{after}", f"n{level}_{corner}")
            bar(f"n{level}_{corner}", f"n{level}_{after}")
        bar(f"n{level}_0", f"n{level}_2")
        bar(f"n{level}_1", f"n{level}_3")
    # Footings that slope towards the middle; a soft spring holds the turn about the vertical axis where all feet slide.
    slope = 0.2
    obstacles, contacts = {}, []
    for corner, (x, y) in enumerate(corners):
        normal = [-slope * x, -slope * y, 1.0]
        obstacles[f"footing{corner}"] = {"kind": "plane", "point": nodes[f"n0_{corner}"], "normal": normal}
        contacts.append({"node": f"n0_{corner}", "obstacle": f"footing{corner}", "friction": 0.4})
    top = [f"n{levels - 1}_{corner}" for corner in range(4)]
    elements.append({"kind": "spring", "nodes": ["n0_0"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 0]], "name": "tie"})
    return {
        "model": {
            "name": "tower on sloped footings", "dimension": 3, "nodes": nodes, "elements": elements,
            "obstacles": obstacles, "contacts": contacts,
            "stages": [
                {"name": "weight", "forces": {node: [0, 0, -10] for node in top}, "until": {"load_above": 1}},
                {"name": "wind", "forces": {node: [1, 0.1, 0] for node in top}},
            ],
        },
        "analysis": {"max_increments": 40, "record": {"elements": "all", "supports": "all"}},
    }


def arch(increments, spans=300):
    """A two-chord arch of 2 * spans nodes on two frictional floors, pushed at its crown."""
    nodes, elements = {}, []
    for place in range(spans):
        x = place / (spans - 1)
        for chord, rise in (("low", 0.2), ("high", 0.22)):
            nodes[f"{chord}{place}"] = [10 * x, 40 * rise * x * (1 - x) + (0.1 if chord == "high" else 0)]

    def bar(one, other):
        elements.append({"kind": "bar", "nodes": [one, other], "axial_stiffness": 1e3})

    for place in range(spans):
        bar(f"low{place}", f"high{place}")
        if place:
            for one in ("low", "high"):
                for other in ("low", "high"):
                    bar(f"{one}{place - 1}", f"{other}{place}")
    last = spans - 1
    return {
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements, "supports": {"low0": ["x", "y"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": f"low{last}", "obstacle": "floor", "friction": 0.5}],
            "stages": [{"name": "push", "forces": {f"high{spans // 2}": [0, -1]}}],
        },
        "analysis": {
            "max_increments": increments,
            "arc_length": {"initial": 1e-4, "max": 1e-4},
            "record": {"elements": "all", "supports": "all"},
        },
    }


def spring_row():
    """Two blocks on a floor between springs, with names."""
    stiffness = [[2, 0], [0, 0]]
    return {
        "model": {
            "dimension": 2, "nodes": {"one": [0, 0], "=two": [1, 0]},
            "elements": [
                {"kind": "spring", "nodes": ["one"], "stiffness": stiffness, "name": "ground"},
                {"kind": "spring", "nodes": ["one", "=two"], "stiffness": stiffness},
            ],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": node, "obstacle": "floor", "friction": 0.3} for node in ("one", "=two")],
            "stages": [
                {"name": "weight", "forces": {"one": [0, -1], "=two": [0, -1]}, "until": {"load_above": 1}},
                {"name": "pull", "forces": {"=two": [1, 0]}, "until": {"load_above": 2}},
            ],
        },
    }


class Check:
    """Counts what was compared; a difference ends the run."""

    compared = 0

    @classmethod
    def equal(cls, what, one, other):
        one, other = numpy.asarray(one), numpy.asarray(other)
        same = one.shape == other.shape
        if same and one.dtype.kind == "f" and other.dtype.kind == "f":
            same = numpy.array_equal(one, other, equal_nan=True)
        elif same:
            same = bool((one == other).all())
        if not same:
            raise SystemExit(f"{what} differs:\n{one}\n{other}")
        cls.compared += one.size


def in_space(vector):
    return list(vector) + [0.0] * (3 - len(vector))


def read_piece(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    failures = []
    reader.AddObserver("ErrorEvent", lambda *_: failures.append(path))
    reader.SetFileName(str(path))
    reader.Update()
    if failures:
        raise SystemExit(f"VTK does not read {path}")
    return reader.GetOutput()


def check_piece(path, request, row):
    model = request["model"]
    grid = read_piece(path)
    nodes = list(model["nodes"])
    Check.equal("points", vtk_to_numpy(grid.GetPoints().GetData()),
                numpy.array([in_space(xyz) for xyz in model["nodes"].values()], dtype=float))
    Check.equal("number of cells", grid.GetNumberOfCells(), len(model["elements"]))
    for place, element in enumerate(model["elements"]):
        cell = grid.GetCell(place)
        points = [cell.GetPointId(end) for end in range(cell.GetNumberOfPoints())]
        Check.equal("cell", points, [nodes.index(node) for node in element["nodes"]])
    points = grid.GetPointData()
    nan = [math.nan] * 3
    dimension = model["dimension"]

    def vectors(values):
        return numpy.array([in_space(values[node][:dimension]) if node in values else nan for node in nodes])

    Check.equal("displacement", vtk_to_numpy(points.GetArray("displacement")), vectors(row["displacements"]))
    names = points.GetAbstractArray("node")
    Check.equal("node", [names.GetValue(place) for place in range(len(nodes))], nodes)
    if any(element["kind"] in ("beam", "rotational_spring") for element in model["elements"]):
        turned = [(row["displacements"].get(node) or [0, 0, math.nan])[2:3] or [math.nan] for node in nodes]
        Check.equal("rotation", vtk_to_numpy(points.GetArray("rotation")), numpy.array(turned, dtype=float)[:, 0])
    if row.get("supports"):
        Check.equal("support_reaction", vtk_to_numpy(points.GetArray("support_reaction")), vectors(row["supports"]))
        if points.GetArray("rotation") is not None and dimension == 2:
            held = [(row["supports"].get(node) or [])[2:3] or [math.nan] for node in nodes]
            Check.equal("support_moment", vtk_to_numpy(points.GetArray("support_moment")), numpy.array(held)[:, 0])
    status = numpy.full(len(nodes), 255)
    gap, reaction = numpy.full(len(nodes), math.nan), numpy.zeros((len(nodes), 3))
    normal, slip = numpy.full(len(nodes), math.nan), numpy.full(len(nodes), math.nan)
    for contact in row["contacts"]:
        place, own = nodes.index(contact["node"]), STATUS[contact["status"]]
        status[place] = own if status[place] == 255 else max(status[place], own)
        gap[place] = numpy.fmin(gap[place], contact["gap"])
        reaction[place] += in_space(contact["reaction"])
        normal[place] = numpy.fmax(normal[place], contact["normal_reaction"])
        slip[place] = numpy.fmax(slip[place], math.sqrt(sum(part * part for part in contact["slip_total"])))
    Check.equal("contact_status", vtk_to_numpy(points.GetArray("contact_status")), status)
    Check.equal("gap", vtk_to_numpy(points.GetArray("gap")), gap)
    Check.equal("contact_reaction", vtk_to_numpy(points.GetArray("contact_reaction")), reaction)
    Check.equal("normal_reaction", vtk_to_numpy(points.GetArray("normal_reaction")), normal)
    Check.equal("slip_total", vtk_to_numpy(points.GetArray("slip_total")), slip)
    count = len(model["elements"])
    axial, forces = numpy.full(count, math.nan), numpy.full((count, 3), math.nan)
    for state in row["elements"]:
        if "axial_force" in state:
            axial[state["element"]] = state["axial_force"]
        if "force" in state:
            forces[state["element"]] = in_space(state["force"])
    cells = grid.GetCellData()
    for name, values in (("axial_force", axial), ("spring_force", forces)):
        if not numpy.isnan(values).all():
            Check.equal(name, vtk_to_numpy(cells.GetArray(name)), values)
    fields = grid.GetFieldData()
    for name, value in (
        ("load_factor", row["load_factor"]), ("arc_length", row["arc_length"]), ("index", row["index"]),
        ("strain_energy", row["energy"]["strain"]), ("bifurcation", int(row["point"]["bifurcation"])),
        ("better_direction", int(row["point"].get("better_direction", False))),
        ("unexplored_modes", row["point"].get("unexplored_modes", 0)),
        ("degenerate", int(row["point"].get("degenerate", False))),
    ):
        Check.equal(name, fields.GetArray(name).GetTuple1(0), float(value))
    Check.equal("applied_force", fields.GetArray("applied_force").GetTuple3(0), in_space(row["applied_forces"]))
    for name, value in (("stage", row["stage"]), ("point", row["point"]["kind"]), ("event", row["point"]["event"] or "")):
        Check.equal(name, fields.GetAbstractArray(name).GetValue(0), value)


def check_pvd(place, request, rows):
    entries = re.findall(r'timestep="([^"]+)" group="" part="0" file="([^"]+)"', place.read_text())
    Check.equal("number of files", len(entries), len(rows))
    times = [float(time) for time, _ in entries]
    if any(one >= other for one, other in zip(times, times[1:])):
        raise SystemExit("the times of the files do not rise")
    for (time_of_file, file), row in zip(entries, rows):
        if abs(float(time_of_file) - row["arc_length"]) > 1e-12 * max(1.0, row["arc_length"]):
            raise SystemExit(f"{file} has the time {time_of_file}")
        check_piece(place.parent / file, request, row)


def column(table, name):
    return table.column(name).to_pylist()


def check_parquet(open_table, request, rows):
    dimension = request["model"]["dimension"]
    axes = AXES[:dimension]
    increments, nodes, elements, contacts = (
        open_table(name) for name in ("increments", "nodes", "elements", "contacts"))
    about = {key.decode(): value.decode() for key, value in (nodes.schema.metadata or {}).items()}
    labels = {f"units.{name}": label for name, label in request["model"].get("units", {}).items()}
    Check.equal("units", {key: value for key, value in about.items() if key.startswith("units.")}, labels)
    for name in ("index", "stage", "load_factor", "arc_length", "step"):
        Check.equal(name, column(increments, name), [row[name] for row in rows])
    for name, key in (("point", "kind"), ("bifurcation", "bifurcation"), ("event", "event")):
        Check.equal(name, column(increments, name), [row["point"][key] for row in rows])
    for name in ("residual", "energy_error", "newton_iterations", "mpec_solves"):
        Check.equal(name, column(increments, name), [row["diagnostics"][name] for row in rows])
    for name in rows[0]["measure"]:
        Check.equal(name, column(increments, f"measure.{name}"), [row["measure"][name] for row in rows])
    expected = [(row["index"], node, vector, row.get("supports", {}).get(node, [None] * dimension))
                for row in rows for node, vector in row["displacements"].items()]
    Check.equal("index", column(nodes, "index"), [index for index, *_ in expected])
    Check.equal("node", column(nodes, "node"), [node for _, node, *_ in expected])
    for place, axis in enumerate(axes):
        Check.equal("displacement", column(nodes, f"displacement_{axis}"), [vector[place] for *_, vector, _ in expected])
        Check.equal("reaction", column(nodes, f"reaction_{axis}"), [vector[place] for *_, vector in expected])
    expected = [(row["index"], state) for row in rows for state in row["elements"]]
    Check.equal("index", column(elements, "index"), [index for index, _ in expected])
    for name in ("element", "name", "axial_force"):
        Check.equal(name, column(elements, name), [state.get(name) for _, state in expected])
    if dimension == 2:
        def third(vector):
            return vector[2] if len(vector) > 2 else None

        rotations = [third(vector) for row in rows for vector in row["displacements"].values()]
        Check.equal("rotation", column(nodes, "rotation"), rotations)
        for place, end in enumerate(("first", "last")):
            for name, key in (("beam_axial_force", "axial_force"), ("shear_force",) * 2, ("bending_moment",) * 2):
                values = [state["ends"][place][key] if "ends" in state else None for _, state in expected]
                Check.equal(name, column(elements, f"{name}_at_{end}_node"), values)
    for place, axis in enumerate(axes):
        values = [state["force"][place] if "force" in state else None for _, state in expected]
        Check.equal("force", column(elements, f"force_{axis}"), values)
    expected = [(row["index"], state) for row in rows for state in row["contacts"]]
    Check.equal("index", column(contacts, "index"), [index for index, _ in expected])
    for name in ("node", "obstacle", "status", "gap", "normal_reaction"):
        Check.equal(name, column(contacts, name), [state[name] for _, state in expected])
    for name in ("tangential_reaction", "slip", "slip_total"):
        for place in range(dimension - 1):
            Check.equal(name, column(contacts, f"{name}_{place + 1}"), [state[name][place] for _, state in expected])
    for place, axis in enumerate(axes):
        Check.equal("reaction", column(contacts, f"reaction_{axis}"), [state["reaction"][place] for _, state in expected])


def solve(program, model, out):
    run = subprocess.run([program, "solve", str(model), "--out", str(out)], capture_output=True, text=True)
    if run.returncode not in (0, 1):
        raise SystemExit(run.stderr)


def rows_of(file):
    return [json.loads(line) for line in file.read_text().splitlines()]


def same_path(row):
    """Without the one value that differs from run to run."""
    return {**row, "diagnostics": {**row["diagnostics"], "elapsed_s": 0.0}}


def pressed_block():
    """Two quadratic hexahedra on a floor under an even traction of 0.06."""
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    nodes, elements, top = {}, [], []
    for cell in range(2):
        own = [(x + 2 * cell, y, z) for x, y, z in corners]
        own += [tuple((a + b) // 2 for a, b in zip(own[one], own[other])) for one, other in edges]
        names = ["n%d_%d_%d" % place for place in own]
        nodes.update({name: [0.5 * part for part in place] for name, place in zip(names, own)})
        elements.append({"kind": "hexahedron20", "nodes": names, "material": "rubber"})
        top.append([name for name in names if name.endswith("_2")])
    return {"model": {
        "dimension": 3, "nodes": nodes, "elements": elements,
        "materials": {"rubber": {"kind": "neo_hookean", "young": 10, "poisson": 0.3}},
        "surfaces": {"top": {"faces": top}}, "supports": {"n0_0_0": ["x", "y"], "n4_0_0": ["y"]},
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": name, "obstacle": "floor"} for name in nodes if name.endswith("_0")],
        "stages": [{"name": "press", "tractions": {"top": [0, 0, -0.06]}, "until": {"load_above": 1}}]}}


def check_contact_pressure(program, folder):
    """An even traction is an even contact pressure and an even strain."""
    model = folder / "pressed.json"
    model.write_text(json.dumps(pressed_block()))
    solve(program, model, folder / "pressed.pvd")
    last = sorted((folder / "pressed").glob("*.vtu"))[-1]
    pressure = vtk_to_numpy(read_piece(last).GetPointData().GetArray("contact_pressure"))
    closed = pressure[~numpy.isnan(pressure)]
    Check.equal("nodes with a contact pressure", len(closed), 13)
    if abs(closed / 0.06 - 1.0).max() > 1e-9:
        raise SystemExit(f"contact pressures of an even traction of 0.06: {closed}")
    strain = vtk_to_numpy(read_piece(last).GetCellData().GetArray("strain"))
    solve(program, model, folder / "pressed.ndjson")
    moved = rows_of(folder / "pressed.ndjson")[-1]["displacements"]
    # Homogeneous: of Green and Lagrange by the sides of the block, (l² - 1)/2.
    sides = [(1 + (moved["n4_2_2"][0] - moved["n0_2_2"][0]) / 2), 1 + moved["n0_2_2"][1] - moved["n0_0_2"][1],
             1 + moved["n0_0_2"][2]]
    expected = [(side ** 2 - 1) / 2 for side in sides] + [0, 0, 0]
    if abs(strain - expected).max() > 1e-12:
        raise SystemExit(f"strains {strain}, expected {expected}")
    Check.compared += strain.size
    print(f"pressed block: strain of Green and Lagrange within {abs(strain - expected).max():.1e}")
    print(f"pressed block: contact pressure 0.06 within {abs(closed / 0.06 - 1.0).max():.1e} at {len(closed)} nodes")


def check_files(program, folder, name, request):
    model = folder / f"{name}.json"
    model.write_text(json.dumps(request))
    for extension in ("ndjson", "pvd", "parquet"):
        solve(program, model, folder / f"{name}.{extension}")
    rows = rows_of(folder / f"{name}.ndjson")
    check_pvd(folder / f"{name}.pvd", request, rows)

    def table(which):
        return pyarrow.parquet.read_table(folder / (f"{name}.parquet" if which == "increments" else f"{name}.{which}.parquet"))

    check_parquet(table, request, rows)
    print(f"{name}: {len(rows)} increments as .pvd and .parquet equal the lines")


def check_http(program, folder, models):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    url = f"http://127.0.0.1:{port}"
    server = subprocess.Popen(
        [program, "serve", "--listen", f"127.0.0.1:{port}", "--database", str(folder / "jobs.db")],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def call(path, body=None):
        asked = urllib.request.Request(url + path, body, {"Content-Type": "application/json"})
        return urllib.request.urlopen(asked, timeout=60).read()

    try:
        for _ in range(300):
            try:
                call("/healthz")
                break
            except OSError:
                time.sleep(0.1)
        for name, request in models.items():
            job = json.loads(call("/v1/jobs", json.dumps(request).encode()))["links"]
            while json.loads(call(job["self"]))["status"] in ("queued", "running"):
                time.sleep(0.05)
            rows, page = [], json.loads(call(job["increments"]))
            while page["increments"]:
                rows += page["increments"]
                page = json.loads(call(f"{job['increments']}?after={page['next_after']}"))
            place = folder / f"http-{name}"
            zipfile.ZipFile(io.BytesIO(call(job["results_pvd"]))).extractall(place)
            check_pvd(place / "path.pvd", request, rows)
            tables = zipfile.ZipFile(io.BytesIO(call(job["results_parquet"])))
            check_parquet(lambda which: pyarrow.parquet.read_table(io.BytesIO(tables.read(f"{which}.parquet"))), request, rows)
            Check.equal("bytes of two archives", call(job["results_parquet"]) == call(job["results_parquet"]), True)
            print(f"{name}: {len(rows)} increments over HTTP as results.pvd and results.parquet equal the lines")
    finally:
        server.terminate()
        server.wait()


def size(folder, stem):
    files = [file for file in folder.rglob("*") if file.is_file() and str(file.relative_to(folder)).startswith(stem)]
    return sum(file.stat().st_size for file in files)


def measure_times(program, folder):
    model = folder / "long.json"
    model.write_text(json.dumps(arch(10_000)))
    base = None
    for extension in ("ndjson", "csv", "parquet", "pvd"):
        start = time.perf_counter()
        solve(program, model, folder / f"long-{extension}.{extension}")
        seconds = time.perf_counter() - start
        base = base or seconds
        print(f"{extension}: {seconds:.1f} s, {seconds / base:.2f} of ndjson, {size(folder, f'long-{extension}') / 1e6:.0f} MB")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--program", required=True)
    arguments.add_argument("--time", action="store_true", help="measure 10,000 increments of 600 nodes")
    arguments = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        if arguments.time:
            measure_times(arguments.program, folder)
            return
        models = {"tower": tower(), "arch": arch(30), "springs": spring_row()}
        beams = pathlib.Path(__file__).parent / "solver/models/arch-on-rough-floor.json"
        models["beams"] = json.loads(beams.read_text())
        for name, request in models.items():
            check_files(arguments.program, folder, name, request)
        check_contact_pressure(arguments.program, folder)
        check_http(arguments.program, folder, models)
        print(f"{Check.compared} values compared, none differs")


if __name__ == "__main__":
    main()
