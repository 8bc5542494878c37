"""Kratos' mortar contact with friction (an augmented Lagrangian) on the mesh of a model of `solid_block.py`, one thread.

    PYTHON kratos_contact.py MODEL.json INCREMENTS_DOWN INCREMENTS_ALONG

Prints seconds of the processor for the increments, the ratio of friction to pressure at the end, and the number of
increments that ended with the largest number of iterations. Needs KratosContactStructuralMechanicsApplication,
KratosConstitutiveLawsApplication and KratosLinearSolversApplication.
"""

import json
import os
import pathlib
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = "1"

import KratosMultiphysics as kratos
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication
from KratosMultiphysics.StructuralMechanicsApplication import structural_mechanics_analysis

# Relative; the program's own is 1e-4.
TOLERANCE = 1e-6
MOST_ITERATIONS = 30


def part(name, **entities):
    lines = [f"Begin SubModelPart {name}"]
    for kind, numbers in entities.items():
        lines += [f"Begin SubModelPart{kind}", *map(str, sorted(numbers)), f"End SubModelPart{kind}"]
    return lines + ["End SubModelPart"]


def write_mesh(model, path):
    numbers = {name: k + 1 for k, name in enumerate(model["nodes"])}
    places = dict(model["nodes"])
    elements = [element["nodes"] for element in model["elements"]]
    contact = model["contacts"][0]
    moved = set(model["stages"][0]["displacements"])
    held = set(model["supports"]) - moved
    own = model["surfaces"][contact["surface"]]["faces"]
    if "against" in contact:
        other = model["surfaces"][contact["against"]]["faces"]
    else:
        corners = {"f0": [-2, -0.5], "f1": [6, -0.5], "f2": [6, 0], "f3": [-2, 0]}
        places |= corners
        numbers |= {name: len(numbers) + k + 1 for k, name in enumerate(corners)}
        elements.append(list(corners))
        held |= set(corners)
        other = [["f3", "f2"]]
    lines = ["Begin Properties 0", "End Properties", "Begin Properties 1", "End Properties", "Begin Nodes"]
    lines += [f"{number} {places[name][0]:.15g} {places[name][1]:.15g} 0" for name, number in numbers.items()]
    lines += ["End Nodes", "Begin Elements TotalLagrangianElement2D4N"]
    lines += [f"{k + 1} 1 " + " ".join(str(numbers[node]) for node in nodes) for k, nodes in enumerate(elements)]
    lines += ["End Elements", "Begin Conditions LineCondition2D2N"]
    lines += [f"{k + 1} 0 {numbers[a]} {numbers[b]}" for k, (a, b) in enumerate(own + other)]
    lines += ["End Conditions"]
    nodes = [{numbers[node] for face in faces for node in face} for faces in (own, other)]
    lines += part("held", Nodes={numbers[name] for name in held}) + part("moved", Nodes={numbers[n] for n in moved})
    lines += part("slave", Nodes=nodes[0], Conditions=range(1, len(own) + 1))
    lines += part("contact", Nodes=nodes[0] | nodes[1], Conditions=range(1, len(own) + len(other) + 1))
    lines += part("bodies", Elements=range(1, len(elements) + 1))
    path.write_text("\n".join(lines) + "\n")


def motions(model, increments):
    """The displacement of the nodes that move at the end of each increment."""
    places, at = [], [0.0, 0.0]
    for stage, count in zip(model["stages"], increments):
        change = next(iter(stage["displacements"].values()))
        places += [[at[k] + change[k] * (step + 1) / count for k in (0, 1)] for step in range(count)]
        at = places[-1]
    return places


def settings(model, folder, count):
    law = next(iter(model["materials"].values()))
    variables = {"YOUNG_MODULUS": law["young"], "POISSON_RATIO": law["poisson"], "DENSITY": 1.0, "THICKNESS": 1.0}
    materials = {"properties": [{
        "model_part_name": "Structure.bodies", "properties_id": 1,
        "Material": {"constitutive_law": {"name": "HyperElasticPlaneStrain2DLaw"}, "Variables": variables, "Tables": {}},
    }]}
    (folder / "materials.json").write_text(json.dumps(materials))
    kinds = ["displacement", "residual"]
    return {
        "problem_data": {"problem_name": "mesh", "parallel_type": "OpenMP", "start_time": 0.0, "end_time": float(count),
                         "echo_level": 0},
        "solver_settings": {
            "solver_type": "Static", "model_part_name": "Structure", "domain_size": 2, "echo_level": 0,
            "analysis_type": "non_linear", "time_stepping": {"time_step": 1.0}, "max_iteration": MOST_ITERATIONS,
            "compute_reactions": True, "reform_dofs_at_each_step": True,
            "model_import_settings": {"input_type": "mdpa", "input_filename": str(folder / "mesh")},
            "material_import_settings": {"materials_filename": str(folder / "materials.json")},
            "contact_settings": {
                "mortar_type": "ALMContactFrictional", "frictional_decomposed": False,
                **{f"contact_{kind}_relative_tolerance": TOLERANCE for kind in kinds},
            },
            "convergence_criterion": "contact_residual_criterion",
            **{f"{kind}_relative_tolerance": TOLERANCE for kind in kinds},
            "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
        },
        "processes": {"contact": [{
            "python_module": "alm_contact_process", "process_name": "ALMContactProcess",
            "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
            "Parameters": {
                "model_part_name": "Structure", "contact_model_part": {"0": ["contact"]},
                "assume_master_slave": {"0": ["slave"]}, "contact_type": "Frictional",
                "friction_coefficients": {"0": model["contacts"][0]["friction"]},
            },
        }]},
    }


class Analysis(structural_mechanics_analysis.StructuralMechanicsAnalysis):
    def __init__(self, space, parameters, places):
        self.space, self.places, self.unconverged = space, places, 0
        super().__init__(space, parameters)

    def ApplyBoundaryConditions(self):
        super().ApplyBoundaryConditions()
        place = self.places[round(self.space["Structure"].ProcessInfo[kratos.TIME]) - 1]
        for name, values in (("held", [0.0, 0.0]), ("moved", place)):
            for node in self.space["Structure." + name].Nodes:
                for variable, value in zip((kratos.DISPLACEMENT_X, kratos.DISPLACEMENT_Y), values):
                    node.Fix(variable)
                    node.SetSolutionStepValue(variable, value)

    def FinalizeSolutionStep(self):
        super().FinalizeSolutionStep()
        iterations = self.space["Structure"].ProcessInfo[kratos.NL_ITERATION_NUMBER]
        self.unconverged += iterations >= MOST_ITERATIONS

    def ratio(self):
        forces = [node.GetSolutionStepValue(kratos.REACTION) for node in self.space["Structure.moved"].Nodes]
        pushed, pressed = (sum(force[k] for force in forces) for k in (0, 1))
        return abs(pushed / pressed)


def main():
    model = json.loads(pathlib.Path(sys.argv[1]).read_text())
    places = motions(model, [int(word) for word in sys.argv[2:4]])
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_mesh(model, folder / "mesh.mdpa")
        parameters = kratos.Parameters(json.dumps(settings(model, folder, len(places))))
        analysis = Analysis(kratos.Model(), parameters, places)
        analysis.Initialize()
        began = time.process_time()
        analysis.RunSolutionLoop()
        seconds = time.process_time() - began
        told = {"seconds": seconds, "ratio": analysis.ratio(), "unconverged": analysis.unconverged}
    print(json.dumps(told), flush=True)
    # Without the farewells of the program's parts.
    os._exit(0)


main()
