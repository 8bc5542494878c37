"""Models that are within every limit of a service and hard to solve."""

import random


def expander(nodes=20_000, bars=120_000, seed=1):
    """Bars between nodes at random, in space: no small separator, so that the factors of the stiffness are nearly full."""
    chance = random.Random(seed)
    places = {f"n{i}": [round(chance.random(), 6) for _ in range(3)] for i in range(nodes)}
    elements = []
    for index in range(bars):
        first = index % nodes
        second = chance.randrange(nodes - 1)
        second += second >= first
        elements.append({"kind": "bar", "nodes": [f"n{first}", f"n{second}"], "axial_stiffness": 1.0})
    return {
        "model": {
            "dimension": 3,
            "nodes": places,
            "supports": {f"n{i}": ["x", "y", "z"] for i in range(4)},
            "elements": elements,
            "stages": [{"name": "push", "forces": {"n9": [1, 0, 0]}, "until": {"load_above": 1.0}}],
        },
        "analysis": {"max_increments": 10},
    }


def springs_on_floor(count, dimension, method="auto"):
    """Nodes in a row, each on a spring to the ground and tied to the next, that touch a floor without reaction: any of them may
    open, stick or slip as the load begins."""
    axes = range(dimension)
    ground = [[(2.0 if row == column else 0.3) for column in axes] for row in axes]
    tie = [[(1.0 if row == column else 0.1) for column in axes] for row in axes]
    names = [f"n{i}" for i in range(count)]
    push = [1.0] + [0.2] * (dimension - 2) + [-0.1]
    return {
        "model": {
            "dimension": dimension,
            "nodes": {name: [float(i)] + [0.0] * (dimension - 1) for i, name in enumerate(names)},
            "elements": [{"kind": "spring", "nodes": [name], "stiffness": ground} for name in names]
            + [{"kind": "spring", "nodes": list(pair), "stiffness": tie} for pair in zip(names, names[1:])],
            "obstacles": {"floor": {"kind": "plane", "point": [0] * dimension, "normal": [0] * (dimension - 1) + [1]}},
            "contacts": [{"node": name, "obstacle": "floor", "friction": 0.4} for name in names],
            "stages": [
                {
                    "name": "push",
                    "forces": {name: push if i % 3 else [-value for value in push] for i, name in enumerate(names)},
                    "until": {"load_above": 1.0},
                }
            ],
        },
        "analysis": {"method": method, "max_increments": 100},
    }
