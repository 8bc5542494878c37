"""Other programs on the mesh of a request of `solid_block.py`: quadrilaterals of a neo-Hookean material, one surface that
touches a floor or another surface, and two stages of displacements, down and along, of the nodes on top.

Each answers seconds of the processor for its increments, the ratio of friction to pressure at the end, and the number of
increments that did not converge, where it is told.
"""

import json
import os
import pathlib
import resource
import subprocess
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"

try:
    import numpy
    import getfem
    getfem.util_trace_level(0)
except ImportError:
    getfem = None

# Increments of each stage.
DOWNWARDS, SIDEWARDS = 4, 16
KRATOS = pathlib.Path(__file__).with_name("kratos_contact.py")


def run(command, folder):
    """Output, seconds of the processor, and the largest memory (MiB) of any run so far."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done, spent, after.ru_maxrss / 1024


def motions(model):
    """The displacement of the nodes on top at the end of each stage, from the start."""
    at, ends = [0.0, 0.0], []
    for stage in model["stages"]:
        change = next(iter(stage["displacements"].values()))
        at = [at[0] + change[0], at[1] + change[1]]
        ends.append(at)
    return ends


def material(model):
    law = next(iter(model["materials"].values()))
    return law["young"], law["poisson"]


def by_getfem(model, cells, _folder):
    """A block of 4 by 1 on a floor: an augmented Lagrangian."""
    young, poisson = material(model)
    friction = model["contacts"][0]["friction"]
    [_, down], [along, _] = motions(model)
    mesh = getfem.Mesh("cartesian", numpy.linspace(0, 4, cells + 1), numpy.linspace(0, 1, cells // 4 + 1))
    outer = mesh.outer_faces()
    upwards = mesh.normal_of_faces(outer)[1]
    mesh.set_region(1, outer[:, upwards < -0.5])
    mesh.set_region(2, outer[:, upwards > 0.5])
    displacement, scalar = getfem.MeshFem(mesh, 2), getfem.MeshFem(mesh, 1)
    displacement.set_classical_fem(1)
    scalar.set_classical_fem(1)
    integration = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = young / (2 * (1 + poisson))
    solver = getfem.Model("real")
    solver.add_fem_variable("u", displacement)
    solver.add_initialized_data("constants", [lame, shear])
    solver.add_finite_strain_elasticity_brick(integration, "Compressible_Neo_Hookean_Bonet", "u", "constants")
    solver.add_initialized_data("moved", [0.0, 0.0])
    solver.add_Dirichlet_condition_with_simplification("u", 2, "moved")
    solver.add_filtered_fem_variable("reaction", displacement, 1)
    solver.add_initialized_fem_data("floor", scalar, scalar.eval("y"))
    solver.add_initialized_data("augmentation", [young * cells / 4])
    solver.add_initialized_data("friction", [friction])
    solver.add_initialized_data("one", [1.0])
    solver.add_fem_data("before", displacement)
    solver.add_integral_contact_with_rigid_obstacle_brick(
        integration, "u", "reaction", "floor", "augmentation", "friction", 1, 1, "one", "before")
    began = time.process_time()
    for k in range(1, DOWNWARDS + SIDEWARDS + 1):
        share = max(k - DOWNWARDS, 0) / SIDEWARDS
        solver.set_variable("moved", [along * share, down * min(k / DOWNWARDS, 1)])
        solver.set_variable("before", solver.variable("u"))
        solver.solve("max_res", 1e-9, "max_iter", 60, "lsearch", "simplest", "lsolver", "mumps")
    spent = time.process_time() - began
    pressed, pushed = (float(getfem.asm("generic", integration, 0, f"reaction({k})", 1, solver)) for k in (2, 1))
    return spent, abs(pushed / pressed), None


def by_calculix(model, cells, folder):
    """A penalty."""
    young, poisson = material(model)
    contact = model["contacts"][0]
    numbers = {name: k + 1 for k, name in enumerate(model["nodes"])}
    elements = [[numbers[node] for node in element["nodes"]] for element in model["elements"]]
    held = set(model["supports"]) - set(model["stages"][0]["displacements"])
    fixed = [numbers[name] for name in held]
    lines = ["*NODE"] + [f"{numbers[name]},{x:.12g},{y:.12g},0" for name, (x, y) in model["nodes"].items()]
    if "against" not in contact:
        first = len(numbers) + 1
        floor = [(-2, -0.5), (6, -0.5), (6, 0), (-2, 0)]
        lines += [f"{first + k},{x},{y},0" for k, (x, y) in enumerate(floor)]
        elements.append([first + k for k in range(4)])
        fixed += elements[-1]
        faces = {"OWN": model["surfaces"][contact["surface"]]["faces"], "OTHER": None}
    else:
        faces = {side: model["surfaces"][contact[which]]["faces"]
                 for side, which in (("OWN", "surface"), ("OTHER", "against"))}
    lines += ["*ELEMENT,TYPE=CPE4,ELSET=BODIES"]
    lines += [f"{k + 1}," + ",".join(map(str, nodes)) for k, nodes in enumerate(elements)]
    lines += ["*NSET,NSET=TOP"] + [f"{numbers[name]}," for name in model["stages"][0]["displacements"]]
    lines += ["*NSET,NSET=FIXED"] + [f"{number}," for number in fixed]
    side_of = {frozenset(pair): (k + 1, side + 1) for k, nodes in enumerate(elements)
               for side, pair in enumerate(zip(nodes, nodes[1:] + nodes[:1]))}
    for name, pairs in faces.items():
        sides = [(len(elements), 3)] if pairs is None else [
            side_of[frozenset(numbers[node] for node in pair)] for pair in pairs]
        lines += [f"*SURFACE,NAME={name},TYPE=ELEMENT"] + [f"{element},S{side}" for element, side in sides]
    shear, bulk = young / (2 * (1 + poisson)), young / (3 * (1 - 2 * poisson))
    penalty = 5 * young * cells
    lines += ["*MATERIAL,NAME=RUBBER", "*HYPERELASTIC,NEO HOOKE", f"{shear / 2:.12g},{2 / bulk:.12g}",
              "*SOLID SECTION,ELSET=BODIES,MATERIAL=RUBBER", "1.",
              "*SURFACE INTERACTION,NAME=ROUGH", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{penalty:g}",
              "*FRICTION", f"{contact['friction']},{penalty / 4:g}",
              "*CONTACT PAIR,INTERACTION=ROUGH,TYPE=SURFACE TO SURFACE", "OWN,OTHER", "*BOUNDARY", "FIXED,1,2"]
    for steps, (along, down) in zip((DOWNWARDS, SIDEWARDS), motions(model)):
        lines += ["*STEP,NLGEOM,INC=200", "*STATIC,DIRECT", f"{1 / steps},1.", "*BOUNDARY", f"TOP,1,1,{along}",
                  f"TOP,2,2,{down}", "*NODE PRINT,NSET=TOP,TOTALS=ONLY,FREQUENCY=100", "RF", "*END STEP"]
    (folder / "block.inp").write_text("\n".join(lines) + "\n")
    _, spent, _ = run(["ccx", "block"], folder)
    totals = [line.split() for line in (folder / "block.dat").read_text().splitlines() if len(line.split()) == 3]
    pushed, pressed, _ = (float(force) for force in totals[-1])
    return spent, abs(pushed / pressed), None


def by_kratos(model, _cells, folder):
    """Mortar contact with an augmented Lagrangian."""
    (folder / "kratos.json").write_text(json.dumps(model))
    command = [sys.executable, str(KRATOS), "kratos.json", str(DOWNWARDS), str(SIDEWARDS)]
    done, _, _ = run(command, folder)
    told = json.loads(done.stdout.splitlines()[-1])
    return told["seconds"], told["ratio"], told["unconverged"]


