"""Lee's frame and the rough arch by `arcslip solve`, beside OpenSees' beams (elasticBeamColumn, corotational) on Lee's frame
and on the arch with its foot held, at the same numbers of elements: milliseconds of the processor an increment, for
arcslip with its start and the reading of the model.

    PYTHON tests/benches/opensees_beams.py target/release/arcslip 20 60 200 2000

arcslip locates events and lists directions; OpenSees follows the path up to the first limit by displacement control of
the loaded node. Each time is the median of several runs in turn. Without openseespy its columns stay empty.
"""

import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError):
    ops = None

RUNS = 3
STEPS = 40


def lee(elements):
    """Places, loaded node, last node, drop up to which OpenSees goes, EA; legs of 1, EI = 1."""
    leg = elements // 2
    places = [(0.0, k / leg) for k in range(leg + 1)] + [(k / leg, 1.0) for k in range(1, leg + 1)]
    return places, leg + leg // 5, 0.35, 43200.0


def arch(elements):
    places = [(math.sin(0.5 * math.pi * k / elements), math.cos(0.5 * math.pi * k / elements)) for k in range(elements)]
    return places + [(1.0, 0.0)], 0, 0.45, 1e5


def request(kind, elements):
    places, loaded, _, axial = (lee if kind == "lee" else arch)(elements)
    last = len(places) - 1
    model = {
        "dimension": 2,
        "nodes": {f"n{k}": place for k, place in enumerate(places)},
        "elements": [
            {"kind": "beam", "nodes": [f"n{k}", f"n{k + 1}"], "axial_stiffness": axial, "bending_stiffness": 1.0}
            for k in range(last)
        ],
        "stages": [{"name": "press", "forces": {f"n{loaded}": [0, -1]}, "until": {"limit_points": 2}}],
    }
    if kind == "lee":
        model["supports"] = {"n0": ["x", "y"], f"n{last}": ["x", "y"]}
    else:
        model["supports"] = {"n0": ["x", "rz"]}
        model["obstacles"] = {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}
        model["contacts"] = [{"node": f"n{last}", "obstacle": "floor", "friction": 0.8}]
    return {"model": model, "analysis": {"max_increments": 3000, "record": {"nodes": [f"n{loaded}"], "elements": "none"}}}


def processor_time_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def by_arcslip(program, kind, elements):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(request(kind, elements), file)
        file.flush()
        before = processor_time_of_children()
        done = subprocess.run([program, "solve", file.name, "--out", os.devnull, "--format", "ndjson"],
                              capture_output=True, text=True)
        spent = processor_time_of_children() - before
    report = json.loads(done.stderr[done.stderr.index('{"stop_reason"'):])
    return spent * 1e3 / report["increments"], report["increments"], report["stop_reason"]


def by_opensees(kind, elements):
    places, loaded, drop, axial = (lee if kind == "lee" else arch)(elements)
    last = len(places) - 1
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for k, (x, y) in enumerate(places):
        ops.node(k + 1, x, y)
    ops.fix(last + 1, 1, 1, 0)
    ops.fix(1, 1, 1 if kind == "lee" else 0, 0 if kind == "lee" else 1)
    ops.geomTransf("Corotational", 1)
    for k in range(last):
        ops.element("elasticBeamColumn", k + 1, k + 1, k + 2, axial, 1.0, 1.0, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(loaded + 1, 0.0, -1.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGen")
    ops.test("NormDispIncr", 1e-8, 30)
    ops.algorithm("Newton")
    ops.integrator("DisplacementControl", loaded + 1, 2, -drop / STEPS)
    ops.analysis("Static")
    began, done = time.process_time(), 0
    while done < STEPS and ops.analyze(1) == 0:
        done += 1
    return (time.process_time() - began) * 1e3 / max(done, 1), done


def main():
    program, sizes = sys.argv[1], [int(size) for size in sys.argv[2:]]
    print("| scene | elements | arcslip, ms | increments | ends as | OpenSees, ms | increments | ratio |")
    print("|---|--:|--:|--:|---|--:|--:|--:|")
    for kind in ("lee", "arch"):
        for elements in sizes:
            ours, theirs = [], []
            for _ in range(RUNS):
                ours.append(by_arcslip(program, kind, elements))
                if ops:
                    theirs.append(by_opensees(kind, elements))
            own = statistics.median(row[0] for row in ours)
            row = f"| {kind} | {elements} | {own:.3f} | {ours[0][1]} | {ours[0][2]} | "
            if theirs:
                other = statistics.median(row[0] for row in theirs)
                row += f"{other:.3f} | {theirs[0][1]} of {STEPS} | {other / own:.2f} |"
            print(row, flush=True)


main()
