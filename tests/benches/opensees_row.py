"""The row of n snapping bars by OpenSees, for the bench `peers`.

Corotational trusses, penalty contact with Coulomb friction (zeroLengthContact2D) and displacement control of the first
tip, which goes on when the others stick: no other tip gets farther past the limit. The step is halved where Newton's
method fails and grows again; a path ends where the smallest step fails, after some failures in all, or
when the tip has gone all the way.

Reads one n a line and answers each with one line of JSON. What is timed are the steps before the first that fails: not
the building of the model, and not the search for a step that converges.
"""

import json
import os
import sys
import time

# Matrices of this size are slower on several threads.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError) as error:
    print(json.dumps({"missing": f"openseespy cannot be imported ({error}); pip install openseespy"}), flush=True)
    sys.exit(0)

# Penalty over EA: at 1e6 the penalty's own error is 1e-6 of the load, and Newton's method still converges.
PENALTY = 1e6
FRICTION = 0.3
STEP = 0.02
SMALLEST_STEP = STEP / 256
MOST_FAILURES = 20
# Travel of a tip that has snapped through.
TRAVEL = 3.0
# No step of a continuous path changes the load by as much: its largest value is 0.28.
JUMP = 0.1


def build(n):
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    ops.uniaxialMaterial("Elastic", 1, 1.0)
    ops.uniaxialMaterial("Elastic", 2, 0.5)
    element = 0
    for i in range(n):
        foot = 1.5 + 0.1 * i / max(n - 1, 1)
        pin, tip, floor = 3 * i + 1, 3 * i + 2, 3 * i + 3
        ops.node(pin, 3.0 * i, 1.0)
        ops.fix(pin, 1, 1)
        ops.node(tip, 3.0 * i - foot, 0.0)
        ops.node(floor, 3.0 * i - foot, 0.0)
        ops.fix(floor, 1, 1)
        element += 1
        ops.element("corotTruss", element, pin, tip, 1.0, 1)
        if i > 0:
            element += 1
            ops.element("corotTruss", element, tip - 3, tip, 1.0, 2)
        element += 1
        ops.element("zeroLengthContact2D", element, tip, floor, PENALTY, PENALTY, FRICTION, "-normal", 0.0, 1.0)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for i in range(n):
        ops.load(3 * i + 2, 1.0, 0.0)
    ops.constraints("Plain")
    # Tips are tied to their neighbours alone: a band of four.
    ops.numberer("RCM")
    ops.system("BandGen")
    ops.test("NormUnbalance", 1e-9, 15)
    ops.algorithm("Newton")


def control(step):
    ops.integrator("DisplacementControl", 2, 1, step)


def run(n):
    build(n)
    step = STEP
    control(step)
    ops.analysis("Static")
    increments, iterations, failures, largest, jump, last = 0, 0, 0, 0.0, 0.0, 0.0
    smooth = None
    began = time.perf_counter()
    while ops.nodeDisp(2, 1) < TRAVEL:
        converged = ops.analyze(1) == 0
        elapsed = time.perf_counter() - began
        if converged:
            increments += 1
            iterations += ops.testIter()
            load = ops.getTime()
            jump = max(jump, abs(load - last))
            last = load
            largest = max(largest, load)
            if step < STEP:
                step *= 2
                control(step)
            continue
        smooth = smooth or (elapsed, increments, iterations)
        failures += 1
        step *= 0.5
        if step < SMALLEST_STEP or failures > MOST_FAILURES:
            break
        control(step)
    elapsed, timed, timed_iterations = smooth or (time.perf_counter() - began, increments, iterations)
    return {
        "elapsed_s": elapsed,
        "increments": timed,
        "iterations": timed_iterations,
        "largest_load": largest,
        "last_load": last,
        "travel": ops.nodeDisp(2, 1),
        "end": ending(jump, smooth is None),
    }


def ending(jump, went_all_the_way):
    if jump > JUMP:
        return f"jumps by {jump:.3f}"
    return "all the way" if went_all_the_way else "stops"


for line in sys.stdin:
    print(json.dumps(run(int(line))), flush=True)
