"""Solids in plane strain, pressed and pushed to full slip, by `arcslip solve` beside GetFEM, CalculiX and Kratos on the
same mesh and one thread: seconds of the processor an increment and for the path.

    PYTHON tests/benches/solid_block.py target/release/arcslip 40 128
    PYTHON tests/benches/solid_block.py target/release/arcslip bodies 16 32 64
    PYTHON tests/benches/solid_block.py target/release/arcslip tied 40 128 448 1400
    PYTHON tests/benches/solid_block.py target/release/arcslip cube 12 20 30 46

The numbers are cells along a block, a quarter of them across: a block of 4 by 1 on a rough plane, or with `bodies` a
block of 3 by 1 on one of 4 by 1. arcslip locates the slip of every node, lists directions and judges each increment;
GetFEM (Debian's python3-getfem) and Kratos (its contact application, of PyPI) solve an augmented Lagrangian of the
contact, CalculiX (`ccx`) a penalty, all in 4 increments down and 16 along. Each time is the median of several runs in
turn. A program that is not installed has no rows. `tied` glues the block to the plane, for arcslip alone: time and
memory. `cube` is a cube in space with so many cells along each edge, glued at its foot and pressed on its top, for
arcslip alone and solved once.
"""

import importlib.util
import json
import os
import pathlib
import shutil
import statistics
import sys
import tempfile

from solid_peers import DOWNWARDS, SIDEWARDS, by_calculix, by_getfem, by_kratos, getfem, run

RUNS = 3
YOUNG, POISSON, FRICTION = 1e3, 0.3, 0.5
DOWN, ALONG = -0.02, 0.06
# The number of increments of a tied block, and of a cube.
TIED, OF_CUBE = 12, 3
# Limits that fit the largest of them.
LIMITS = ["--max-memory", "20GiB", "--max-factor-entries", "1000000000", "--max-factor-work", "100000000000000"]


def block(letter, cells, width, corner):
    """A block's nodes, its elements, and the names of the nodes of its foot and its top."""
    across = cells // 4
    name = (letter + "{}_{}").format
    nodes = {name(c, r): [corner[0] + width * c / cells, corner[1] + r / across]
             for r in range(across + 1) for c in range(cells + 1)}
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    elements = [{"kind": "quadrilateral4", "nodes": [name(c + right, r + up) for right, up in corners],
                 "material": "rubber", "plane": "strain"} for r in range(across) for c in range(cells)]
    foot, top = ([name(column, row) for column in range(cells + 1)] for row in (0, across))
    return nodes, elements, foot, top


def pushed(blocks, held, top, parts, is_tied=False):
    """The request for blocks of which the top is pressed and pushed."""
    model = {
        "dimension": 2,
        "nodes": {name: place for nodes, *_ in blocks for name, place in nodes.items()},
        "materials": {"rubber": {"kind": "neo_hookean", "young": YOUNG, "poisson": POISSON}},
        "elements": [element for _, elements, *_ in blocks for element in elements],
        "supports": {node: ["x", "y"] for node in held + top},
        **parts,
        "stages": [
            {"name": "press", "displacements": {node: [0, DOWN] for node in top}, "until": {"load_above": 1}},
            {"name": "push", "displacements": {node: [ALONG, 0] for node in top}, "until": {"load_above": 1}},
        ],
    }
    increments = TIED if is_tied else 10_000
    return {"model": model, "analysis": {"max_increments": increments, "record": {"elements": "none", "nodes": []}}}


def faces(nodes):
    return {"faces": [list(pair) for pair in zip(nodes, nodes[1:])]}


def request(cells, is_tied=False):
    own = block("n", cells, 4, (0, 0))
    _, _, foot, top = own
    contacts = [] if is_tied else [{"surface": "foot", "obstacle": "floor", "friction": FRICTION}]
    floor = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    parts = {"surfaces": {"foot": faces(foot)}, "obstacles": {"floor": floor}, "contacts": contacts}
    return pushed([own], foot if is_tied else [], top, parts, is_tied)


def bodies_request(cells):
    lower, upper = block("l", cells, 4, (0, 0)), block("u", cells, 3, (0.25, 1))
    parts = {
        "surfaces": {"upper": faces(upper[2]), "lower": faces(lower[3])},
        "contacts": [{"surface": "upper", "against": "lower", "friction": FRICTION}],
    }
    return pushed([lower, upper], lower[2], upper[3], parts)


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


def beside_peers(program, asked, peers, folder):
    """Rows of a table for one request."""
    rows = {"arcslip": []} | {peer: [] for peer in peers}
    for _ in range(RUNS):
        spent, increments, ratio, _, _ = by_arcslip(program, asked, folder)
        rows["arcslip"].append((spent, increments, ratio, 0))
        for peer, solve in peers.items():
            spent, ratio, unconverged = solve(asked["model"], folder)
            rows[peer].append((spent, DOWNWARDS + SIDEWARDS, ratio, "not told" if unconverged is None else unconverged))
    for who, runs in rows.items():
        spent = statistics.median(row[0] for row in runs)
        _, increments, ratio, unconverged = runs[0]
        yield who, f"{increments} | {spent / increments:.3g} | {spent:.3g} | {ratio:.6f} | {unconverged} |"


def table(program, scenes, peers, folder):
    print("| unknowns | contacts | program | increments | s an increment | s for the path | Q/N at the end | unconverged |")
    print("|--:|--:|---|--:|--:|--:|--:|--:|")
    for cells, asked in scenes:
        of_cells = {peer: lambda model, folder, solve=solve: solve(model, cells, folder) for peer, solve in peers.items()}
        unknowns = 2 * (len(asked["model"]["nodes"]) - len(asked["model"]["supports"]))
        for who, row in beside_peers(program, asked, of_cells, folder):
            print(f"| {unknowns:,} | {cells + 1} | {who} | {row}", flush=True)


def installed(names):
    known = {
        "GetFEM": (by_getfem, getfem is not None),
        "CalculiX": (by_calculix, shutil.which("ccx") is not None),
        "Kratos": (by_kratos, importlib.util.find_spec("KratosMultiphysics") is not None),
    }
    return {name: known[name][0] for name in names if known[name][1]}


def on_plane(program, sizes, folder):
    scenes = ((cells, request(cells)) for cells in sizes)
    table(program, scenes, installed(["GetFEM", "CalculiX", "Kratos"]), folder)


def bodies(program, sizes, folder):
    scenes = ((cells, bodies_request(cells)) for cells in sizes)
    table(program, scenes, installed(["CalculiX", "Kratos"]), folder)


def main():
    program, words = os.path.abspath(sys.argv[1]), sys.argv[2:]
    modes = {"tied": tied, "cube": cube, "bodies": bodies}
    measure = next((modes[word] for word in words if word in modes), on_plane)
    sizes = [int(word) for word in words if word not in modes]
    with tempfile.TemporaryDirectory() as folder:
        measure(program, sizes, pathlib.Path(folder))


if __name__ == "__main__":
    main()
