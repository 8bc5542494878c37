"""A solid block of 4 by 1 in plane strain, pressed on a rough plane and pushed to full slip, by `arcslip solve` beside
GetFEM and CalculiX on the same mesh and one thread: seconds of the processor an increment and for the path.

    PYTHON tests/benches/solid_block.py target/release/arcslip 40 128
    PYTHON tests/benches/solid_block.py target/release/arcslip tied 40 128 448 1400
    PYTHON tests/benches/solid_block.py target/release/arcslip cube 12 20 30 46

The numbers are cells along the block, a quarter of them across. arcslip locates the slip of every node, lists
directions and judges each increment; GetFEM (Debian's python3-getfem) solves an augmented Lagrangian of the contact,
CalculiX (`ccx`) a penalty, both in 4 increments down and 16 along. Each time is the median of several runs in turn.
A program that is not installed has no rows. `tied` glues the block to the plane, for arcslip alone: time and memory.
`cube` is a cube in space with so many cells along each edge, glued at its foot and pressed on its top, for arcslip
alone and solved once.
"""

import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = "1"

try:
    import numpy
    import getfem
    getfem.util_trace_level(0)
except ImportError:
    getfem = None

RUNS = 3
YOUNG, POISSON, FRICTION = 1e3, 0.3, 0.5
DOWN, ALONG = -0.02, 0.06
DOWNWARDS, SIDEWARDS = 4, 16
# The number of increments of a tied block, and of a cube.
TIED, OF_CUBE = 12, 3
# Limits that fit the largest of them.
LIMITS = ["--max-memory", "20GiB", "--max-factor-entries", "1000000000", "--max-factor-work", "100000000000000"]


def request(cells, is_tied):
    across = cells // 4
    name = "n{}_{}".format
    top, foot = ([name(column, row) for column in range(cells + 1)] for row in (across, 0))
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    held = {node: ["x", "y"] for node in (top + foot if is_tied else top)}
    model = {
        "dimension": 2,
        "nodes": {name(c, r): [4 * c / cells, r / across] for r in range(across + 1) for c in range(cells + 1)},
        "materials": {"rubber": {"kind": "neo_hookean", "young": YOUNG, "poisson": POISSON}},
        "elements": [
            {"kind": "quadrilateral4", "nodes": [name(c + right, r + up) for right, up in corners],
             "material": "rubber", "plane": "strain"}
            for r in range(across) for c in range(cells)
        ],
        "supports": held,
        "surfaces": {"foot": {"faces": [list(pair) for pair in zip(foot, foot[1:])]}},
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [] if is_tied else [{"surface": "foot", "obstacle": "floor", "friction": FRICTION}],
        "stages": [
            {"name": "press", "displacements": {node: [0, DOWN] for node in top}, "until": {"load_above": 1}},
            {"name": "push", "displacements": {node: [ALONG, 0] for node in top}, "until": {"load_above": 1}},
        ],
    }
    increments = TIED if is_tied else 10_000
    return {"model": model, "analysis": {"max_increments": increments, "record": {"elements": "none", "nodes": []}}}


def cube_request(cells):
    edge = range(cells + 1)
    name = "n{}_{}_{}".format
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    foot, top = ([name(i, j, k) for j in edge for i in edge] for k in (0, cells))
    model = {
        "dimension": 3,
        "nodes": {name(i, j, k): [i / cells, j / cells, k / cells] for k in edge for j in edge for i in edge},
        "materials": {"rubber": {"kind": "neo_hookean", "young": YOUNG, "poisson": POISSON}},
        "elements": [
            {"kind": "hexahedron8", "nodes": [name(i + a, j + b, k + c) for a, b, c in corners], "material": "rubber"}
            for k in range(cells) for j in range(cells) for i in range(cells)
        ],
        "supports": {node: ["x", "y", "z"] for node in foot + top},
        "stages": [
            {"name": "press", "displacements": {node: [0, 0, DOWN] for node in top}, "until": {"load_above": 1}},
        ],
    }
    return {"model": model, "analysis": {"max_increments": OF_CUBE, "record": {"elements": "none", "nodes": []}}}


def run(command, folder):
    """Output, seconds of the processor, and the largest memory (MiB) of any run so far."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done, spent, after.ru_maxrss / 1024


def by_arcslip(program, asked, folder):
    (folder / "block.json").write_text(json.dumps(asked))
    done, spent, memory = run([program, "solve", "block.json", "--out", "path.ndjson", *LIMITS], folder)
    report = json.loads(done.stderr[done.stderr.index('{"stop_reason"'):])
    lines = [json.loads(line) for line in (folder / "path.ndjson").open()]
    increments = [line for line in lines if "index" in line and "contacts" in line]
    last = increments[-1]["contacts"]
    ratio = None
    if last:
        tangential = sum(contact["tangential_reaction"][0] for contact in last)
        ratio = abs(tangential) / sum(contact["normal_reaction"] for contact in last)
    return spent, report["increments"], ratio, memory, report["elapsed_s"]


def by_getfem(cells, _folder):
    mesh = getfem.Mesh("cartesian", numpy.linspace(0, 4, cells + 1), numpy.linspace(0, 1, cells // 4 + 1))
    outer = mesh.outer_faces()
    upwards = mesh.normal_of_faces(outer)[1]
    mesh.set_region(1, outer[:, upwards < -0.5])
    mesh.set_region(2, outer[:, upwards > 0.5])
    displacement, scalar = getfem.MeshFem(mesh, 2), getfem.MeshFem(mesh, 1)
    displacement.set_classical_fem(1)
    scalar.set_classical_fem(1)
    integration = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG / (2 * (1 + POISSON))
    model = getfem.Model("real")
    model.add_fem_variable("u", displacement)
    model.add_initialized_data("constants", [lame, shear])
    model.add_finite_strain_elasticity_brick(integration, "Compressible_Neo_Hookean_Bonet", "u", "constants")
    model.add_initialized_data("moved", [0.0, 0.0])
    model.add_Dirichlet_condition_with_simplification("u", 2, "moved")
    model.add_filtered_fem_variable("reaction", displacement, 1)
    model.add_initialized_fem_data("floor", scalar, scalar.eval("y"))
    model.add_initialized_data("augmentation", [YOUNG * cells / 4])
    model.add_initialized_data("friction", [FRICTION])
    model.add_initialized_data("one", [1.0])
    model.add_fem_data("before", displacement)
    model.add_integral_contact_with_rigid_obstacle_brick(
        integration, "u", "reaction", "floor", "augmentation", "friction", 1, 1, "one", "before")
    began = time.process_time()
    for k in range(1, DOWNWARDS + SIDEWARDS + 1):
        along = max(k - DOWNWARDS, 0) / SIDEWARDS
        model.set_variable("moved", [ALONG * along, DOWN * min(k / DOWNWARDS, 1)])
        model.set_variable("before", model.variable("u"))
        model.solve("max_res", 1e-9, "max_iter", 60, "lsearch", "simplest", "lsolver", "mumps")
    spent = time.process_time() - began
    pressed, pushed = (float(getfem.asm("generic", integration, 0, f"reaction({k})", 1, model)) for k in (2, 1))
    return spent, abs(pushed / pressed)


def by_calculix(cells, folder):
    across = cells // 4

    def number(column, row):
        return row * (cells + 1) + column + 1

    lines = ["*NODE"]
    lines += [f"{number(c, r)},{4 * c / cells:.12g},{r / across:.12g},0"
              for r in range(across + 1) for c in range(cells + 1)]
    first = (cells + 1) * (across + 1) + 1
    floor = [(-2, -0.5), (6, -0.5), (6, 0), (-2, 0)]
    lines += [f"{first + k},{x},{y},0" for k, (x, y) in enumerate(floor)]
    lines += ["*ELEMENT,TYPE=CPE4,ELSET=BODY"]
    quads = [(c, r) for r in range(across) for c in range(cells)]
    lines += [f"{k + 1},{number(c, r)},{number(c + 1, r)},{number(c + 1, r + 1)},{number(c, r + 1)}"
              for k, (c, r) in enumerate(quads)]
    lines += ["*ELEMENT,TYPE=CPE4,ELSET=FLOOR", f"{len(quads) + 1},{first},{first + 1},{first + 2},{first + 3}"]
    lines += ["*NSET,NSET=TOP"] + [f"{number(column, across)}," for column in range(cells + 1)]
    lines += ["*NSET,NSET=FIXED"] + [f"{first + k}," for k in range(4)]
    lines += ["*SURFACE,NAME=FOOT,TYPE=ELEMENT"] + [f"{column + 1},S1" for column in range(cells)]
    lines += ["*SURFACE,NAME=PLANE,TYPE=ELEMENT", f"{len(quads) + 1},S3"]
    shear, bulk = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
    lines += ["*MATERIAL,NAME=RUBBER", "*HYPERELASTIC,NEO HOOKE", f"{shear / 2:.12g},{2 / bulk:.12g}"]
    lines += [line for part in ("BODY", "FLOOR") for line in (f"*SOLID SECTION,ELSET={part},MATERIAL=RUBBER", "1.")]
    penalty = 5 * YOUNG * cells
    lines += ["*SURFACE INTERACTION,NAME=ROUGH", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{penalty:g}",
              "*FRICTION", f"{FRICTION},{penalty / 4:g}",
              "*CONTACT PAIR,INTERACTION=ROUGH,TYPE=SURFACE TO SURFACE", "FOOT,PLANE", "*BOUNDARY", "FIXED,1,2"]
    for steps, along in ((DOWNWARDS, 0.0), (SIDEWARDS, ALONG)):
        lines += ["*STEP,NLGEOM,INC=200", "*STATIC,DIRECT", f"{1 / steps},1.", "*BOUNDARY", f"TOP,1,1,{along}",
                  f"TOP,2,2,{DOWN}", "*NODE PRINT,NSET=TOP,TOTALS=ONLY,FREQUENCY=100", "RF", "*END STEP"]
    (folder / "block.inp").write_text("\n".join(lines) + "\n")
    _, spent, _ = run(["ccx", "block"], folder)
    totals = [line.split() for line in (folder / "block.dat").read_text().splitlines() if len(line.split()) == 3]
    pushed, pressed, _ = (float(force) for force in totals[-1])
    return spent, abs(pushed / pressed)


def table_of(program, scenes, runs, folder):
    print("| unknowns | ms an increment | increments | largest memory, MiB | bytes an unknown |")
    print("|--:|--:|--:|--:|--:|")
    for unknowns, asked in scenes:
        rows = [by_arcslip(program, asked, folder) for _ in range(runs)]
        elapsed = statistics.median(row[4] for row in rows)
        memory = rows[-1][3]
        print(f"| {unknowns:,} | {elapsed * 1e3 / rows[0][1]:.3g} | {rows[0][1]} | {memory:.0f} | "
              f"{memory * 2**20 / unknowns:,.0f} |", flush=True)


def tied(program, sizes, folder):
    scenes = ((2 * (cells + 1) * (cells // 4 - 1), request(cells, True)) for cells in sorted(sizes))
    table_of(program, scenes, RUNS, folder)


def cube(program, sizes, folder):
    scenes = ((3 * (cells + 1) ** 2 * (cells - 1), cube_request(cells)) for cells in sorted(sizes))
    table_of(program, scenes, 1, folder)


def beside_peers(program, sizes, folder):
    peers = [("GetFEM", by_getfem if getfem else None), ("CalculiX", by_calculix if shutil.which("ccx") else None)]
    print("| unknowns | contacts | program | increments | s an increment | s for the path | Q/N at the end |")
    print("|--:|--:|---|--:|--:|--:|--:|")
    for cells in sizes:
        rows = {"arcslip": []} | {peer: [] for peer, solve in peers if solve}
        for _ in range(RUNS):
            spent, increments, ratio, _, _ = by_arcslip(program, request(cells, False), folder)
            rows["arcslip"].append((spent, increments, ratio))
            for peer, solve in peers:
                if solve:
                    spent, ratio = solve(cells, folder)
                    rows[peer].append((spent, DOWNWARDS + SIDEWARDS, ratio))
        for who, runs in rows.items():
            spent = statistics.median(row[0] for row in runs)
            _, increments, ratio = runs[0]
            unknowns = 2 * (cells + 1) * (cells // 4)
            print(f"| {unknowns:,} | {cells + 1} | {who} | {increments} | {spent / increments:.3g} | {spent:.3g} | "
                  f"{ratio:.6f} |", flush=True)


def main():
    program, words = os.path.abspath(sys.argv[1]), sys.argv[2:]
    modes = {"tied": tied, "cube": cube}
    measure = next((modes[word] for word in words if word in modes), beside_peers)
    sizes = [int(word) for word in words if word not in modes]
    with tempfile.TemporaryDirectory() as folder:
        measure(program, sizes, pathlib.Path(folder))


main()
