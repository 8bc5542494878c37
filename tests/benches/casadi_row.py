"""The row of n snapping bars by CasADi and IPOPT, for the bench `peers`.

Each increment is the paper's program (Kanno and Martins, 2006),

    max  -r_t·Δu_t - ½ γ1 ‖(Δu, Δs)‖² + γ2 (u̇, ṡ)·(Δu, Δs)
    s.t. equilibrium; y >= 0, r_n >= 0, y r_n <= ε; λ >= |Δu_t|, μ r_n >= |r_t|, μ r_n λ + r_t Δu_t <= ε

with the complementarity relaxed by one small ε. The program is built once; its parameters are the last point, the last
direction, the last tractions and γ1, which follows the length of the steps. IPOPT starts from the last point and its
multipliers.

Reads one n a line and answers each with one line of JSON. What is timed is the solution of the programs, not building
them.
"""

import json
import os
import sys
import time

# Matrices of this size are slower on several threads.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

try:
    import casadi as ca
    import numpy as np
except ImportError as error:
    print(json.dumps({"missing": f"casadi cannot be imported ({error}); pip install casadi numpy"}), flush=True)
    sys.exit(0)

FRICTION = 0.3
EPSILON = 1e-8
ARC_LENGTH = 0.1
FORWARD_WEIGHT = 1.0
# A path ends there, when IPOPT fails, when steps collapse, or when the first tip has snapped through.
MOST_INCREMENTS = 80
TRAVEL = 3.0

OPTIONS = {
    "expand": True,
    "print_time": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-8,
        "max_iter": 300,
        "mu_init": 1e-4,
        "mu_strategy": "adaptive",
        "warm_start_init_point": "yes",
        "warm_start_bound_push": 1e-8,
        "warm_start_mult_bound_push": 1e-8,
        "warm_start_slack_bound_push": 1e-8,
    },
}


class Program:
    def __init__(self, n):
        self.n = n
        feet = np.array([1.5 + 0.1 * i / max(n - 1, 1) for i in range(n)])
        places = 3.0 * np.arange(n) - feet
        x, y, r_n, r_t, slip, s = (
            ca.SX.sym("x", n),
            ca.SX.sym("y", n),
            ca.SX.sym("r_n", n),
            ca.SX.sym("r_t", n),
            ca.SX.sym("slip", n),
            ca.SX.sym("s"),
        )
        last, direction = ca.SX.sym("last", 2 * n + 1), ca.SX.sym("direction", 2 * n + 1)
        last_traction, arc_weight = ca.SX.sym("last_traction", n), ca.SX.sym("arc_weight")

        force_x, force_y = [0] * n, [0] * n
        for i in range(n):
            rest = float(np.hypot(feet[i], 1.0))
            along_x, along_y = x[i] - feet[i], y[i] - 1.0
            length = ca.sqrt(along_x**2 + along_y**2)
            tension = (length - rest) / rest
            force_x[i] += tension * along_x / length
            force_y[i] += tension * along_y / length
        for i in range(1, n):
            rest = float(places[i] - places[i - 1])
            along_x, along_y = rest + x[i] - x[i - 1], y[i] - y[i - 1]
            length = ca.sqrt(along_x**2 + along_y**2)
            tension = 0.5 * (length - rest) / rest
            force_x[i] += tension * along_x / length
            force_x[i - 1] -= tension * along_x / length
            force_y[i] += tension * along_y / length
            force_y[i - 1] -= tension * along_y / length

        motion = ca.vertcat(x, y, s) - last
        slid = x - last[:n]
        objective = (
            ca.dot(last_traction, slid)
            + 0.5 * arc_weight * ca.sumsqr(motion)
            - FORWARD_WEIGHT * ca.dot(direction, motion)
        )
        constraints = ca.vertcat(
            ca.vertcat(*force_x) - s - r_t,
            ca.vertcat(*force_y) - r_n,
            slip - slid,
            slip + slid,
            FRICTION * r_n - r_t,
            FRICTION * r_n + r_t,
            y * r_n,
            FRICTION * r_n * slip + r_t * slid,
        )
        infinity = np.inf
        self.lower_g = np.concatenate([np.zeros(2 * n), np.zeros(4 * n), np.full(2 * n, -infinity)])
        self.upper_g = np.concatenate([np.zeros(2 * n), np.full(4 * n, infinity), np.full(2 * n, EPSILON)])
        # Unknowns: x, y, s, r_n, r_t, slip.
        free, positive = np.full(n, -infinity), np.zeros(n)
        self.lower = np.concatenate([free, positive, [-infinity], positive, free, positive])
        unknowns = ca.vertcat(x, y, s, r_n, r_t, slip)
        parameters = ca.vertcat(last, direction, last_traction, arc_weight)
        program = {"x": unknowns, "p": parameters, "f": objective, "g": constraints}
        self.solver = ca.nlpsol("increment", "ipopt", program, OPTIONS)

    def run(self):
        n = self.n
        point = np.zeros(2 * n + 1)
        traction = np.zeros(n)
        direction = np.zeros(2 * n + 1)
        direction[:n] = 1.0
        direction /= np.linalg.norm(direction)
        guess = np.zeros(5 * n + 1)
        arc_weight = FORWARD_WEIGHT / ARC_LENGTH
        bound_multipliers, multipliers = 0, 0
        increments, iterations, largest, last, end = 0, 0, 0.0, 0.0, "all increments"
        began = time.perf_counter()
        while increments < MOST_INCREMENTS:
            ahead = point + ARC_LENGTH * direction
            ahead[n : 2 * n] = np.maximum(ahead[n : 2 * n], 0.0)
            guess[: 2 * n + 1] = ahead
            guess[4 * n + 1 :] = np.abs(ahead[:n] - point[:n])
            found = self.solver(
                x0=guess,
                p=np.concatenate([point, direction, traction, [arc_weight]]),
                lbx=self.lower,
                lbg=self.lower_g,
                ubg=self.upper_g,
                lam_x0=bound_multipliers,
                lam_g0=multipliers,
            )
            stats = self.solver.stats()
            iterations += stats["iter_count"]
            if not stats["success"]:
                end = stats["return_status"]
                break
            increments += 1
            bound_multipliers, multipliers = found["lam_x"], found["lam_g"]
            guess = np.array(found["x"]).ravel()
            motion = guess[: 2 * n + 1] - point
            length = np.linalg.norm(motion)
            if length < 1e-4 * ARC_LENGTH:
                end = "steps collapse"
                break
            point, direction, traction = guess[: 2 * n + 1].copy(), motion / length, guess[3 * n + 1 : 4 * n + 1].copy()
            # The dissipation lengthens the steps while the tips slip: γ1 is led so that they have the length asked for.
            arc_weight *= np.clip(length / ARC_LENGTH, 0.25, 4.0)
            last = point[2 * n]
            largest = max(largest, last)
            if point[0] >= TRAVEL:
                end = "snapped through"
                break
        elapsed = time.perf_counter() - began
        slid = np.abs(direction[:n]) > 1e-3
        return {
            "elapsed_s": elapsed,
            "increments": increments,
            "iterations": iterations,
            "largest_load": largest,
            "last_load": last,
            "travel": point[0],
            "slipping": int(slid.sum()),
            "end": end,
        }


programs = {}
for line in sys.stdin:
    size = int(line)
    if size not in programs:
        programs[size] = Program(size)
    print(json.dumps(programs[size].run()), flush=True)
