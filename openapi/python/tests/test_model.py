"""Models without the program: what is built, from lists and from arrays."""

import base64
import json
import os
import pathlib
import tempfile
import unittest

import arcslip
from arcslip.errors import value_at

try:
    import meshio
    import numpy
except ImportError:
    numpy = meshio = None


class Building(unittest.TestCase):
    def test_every_part_of_a_request(self):
        model = arcslip.Model(2, name="arch", units={"length": "m", "force": "kN"})
        self.assertEqual(model.nodes([(-5, 0), (0, 0.3), (5, 0)]), ["n0", "n1", "n2"])
        model.support(0)
        model.support("n2", "y")
        self.assertEqual(model.bars([(0, 1), ("n1", "n2")], 2.1e5, strain="green"), [0, 1])
        self.assertEqual(model.spring(-1, stiffness=7, name="tie"), 2)
        model.plane("floor", (0, 0), (0, 1))
        model.ball("drum", center=(0, 2), radius=0.5, side="outside")
        model.polyline("ramp", [(0, 0), (4, 1)], rounding=0.5)
        self.assertEqual(model.contact(2, "floor", 0.3), 0)
        model.stage(
            "push", {1: (0, -1)}, {"n0": (0, -0.1)}, {"floor": (0, 1)}, {"load_above": 3},
            obstacle_rotation={"drum": {"angle": 0.5, "about": (0, 1)}},
        )
        self.assertEqual(model.request(max_increments=5, arc_length={"max": 0.1}), {
            "model": {
                "dimension": 2, "name": "arch", "units": {"length": "m", "force": "kN"},
                "nodes": {"n0": [-5.0, 0.0], "n1": [0.0, 0.3], "n2": [5.0, 0.0]},
                "elements": [
                    {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 2.1e5, "strain": "green"},
                    {"kind": "bar", "nodes": ["n1", "n2"], "axial_stiffness": 2.1e5, "strain": "green"},
                    {"kind": "spring", "nodes": ["n2"], "stiffness": [[7, 0.0], [0.0, 7]], "name": "tie"},
                ],
                "stages": [{
                    "name": "push", "forces": {"n1": [0, -1]}, "displacements": {"n0": [0, -0.1]},
                    "obstacle_motion": {"floor": [0, 1]}, "obstacle_rotation": {"drum": {"angle": 0.5, "about": [0, 1]}},
                    "until": {"load_above": 3},
                }],
                "supports": {"n0": ["x", "y"], "n2": ["y"]},
                "obstacles": {
                    "floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                    "drum": {"kind": "ball", "center": [0, 2], "radius": 0.5, "side": "outside"},
                    "ramp": {"kind": "polyline", "points": [[0, 0], [4, 1]], "closed": False, "rounding": 0.5},
                },
                "contacts": [{"node": "n2", "obstacle": "floor", "friction": 0.3}],
            },
            "analysis": {"max_increments": 5, "arc_length": {"max": 0.1}},
        })

    def test_a_cylinder(self):
        model = arcslip.Model(3)
        model.node("a", 0, 0, 1)
        self.assertEqual(model.cylinder("drum", (0, 0, -1), (1, 0, 0), 2), "drum")
        drum = {"kind": "cylinder", "point": [0, 0, -1], "axis": [1, 0, 0], "radius": 2, "side": "outside"}
        self.assertEqual(model.request()["model"]["obstacles"], {"drum": drum})

    def test_a_polyline_in_space(self):
        model = arcslip.Model(3)
        section = {"origin": (0, 0, 0), "x": (1, 0, 0), "y": (0, 0, 1)}
        model.polyline("ramp", [(0, 0), (4, 1)], rounding=0.5, section=section)
        ramp = model.request()["model"]["obstacles"]["ramp"]
        self.assertEqual(ramp["section"], {"origin": [0, 0, 0], "x": [1, 0, 0], "y": [0, 0, 1]})

    def test_boxes_and_triangle_meshes(self):
        model = arcslip.Model(3)
        model.box("block", (0, 0, -1), (4, 4, 2), rounding=0.2, x=(1, 1, 0), y=(-1, 1, 0))
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        model.triangle_mesh("tip", points, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], rounding=0.1, side="inside")
        self.assertEqual(model.request()["model"]["obstacles"], {
            "block": {
                "kind": "box", "center": [0, 0, -1], "size": [4, 4, 2], "side": "outside", "rounding": 0.2,
                "x": [1, 1, 0], "y": [-1, 1, 0],
            },
            "tip": {
                "kind": "triangle_mesh", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
                "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], "rounding": 0.1, "side": "inside",
            },
        })
        flat = arcslip.Model(2)
        self.assertEqual(flat.box("step", (0, 0), (2, 1)), "step")
        step = {"kind": "box", "center": [0, 0], "size": [2, 1], "side": "outside"}
        self.assertEqual(flat.request()["model"]["obstacles"], {"step": step})

    @unittest.skipIf(numpy is None, "numpy and meshio are not installed")
    def test_a_triangle_mesh_of_a_file(self):
        points = numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "die.stl")
            meshio.write(file, meshio.Mesh(points, [("triangle", numpy.array(triangles))]))
            model = arcslip.Model(3)
            model.triangle_mesh("die", file, rounding=0.1)
        die = model.request()["model"]["obstacles"]["die"]
        # A file of triangles repeats their corners; points at one place are one point.
        self.assertEqual((len(die["points"]), len(die["triangles"])), (4, 4))
        with self.assertRaisesRegex(ValueError, "no cells `triangle`"):
            model.triangle_mesh("none", meshio.Mesh(points, [("line", numpy.array([[0, 1]]))]), rounding=0.1)

    def test_a_request_is_a_copy(self):
        model = arcslip.Model(2)
        model.node("a", 0, 0)
        model.request()["model"]["nodes"]["a"][0] = 7.0
        self.assertEqual(model.request()["model"]["nodes"]["a"], [0.0, 0.0])

    def test_what_python_can_tell_at_once(self):
        model = arcslip.Model(2)
        model.node("a", 0, 0)
        with self.assertRaisesRegex(ValueError, "already"):
            model.node("a", 1, 0)
        with self.assertRaisesRegex(IndexError, "no node 3"):
            model.bar("a", 3, 1.0)
        with self.assertRaisesRegex(ValueError, "2 bars and 3 values of axial_stiffness"):
            model.bars([("a", "b"), ("b", "c")], [1, 2, 3])
        with self.assertRaisesRegex(ValueError, "pair"):
            model.bars([("a", "b", "c")], 1.0)
        for wrong in (True, 0.5, None):
            with self.assertRaisesRegex(TypeError, "whole number"):
                model.contact(wrong, "floor")
        with self.assertRaisesRegex(ValueError, "2 coordinates"):
            model.node("b", 1, 0, 0)
        with self.assertRaisesRegex(ValueError, "'z' is no component"):
            model.support("a", "xz")
        with self.assertRaisesRegex(ValueError, "2 or 3"):
            arcslip.Model(4)
        with self.assertRaisesRegex(TypeError, "dict from nodes"):
            model.stage("push", [0, -1])
        with self.assertRaisesRegex(TypeError, "scene"):
            arcslip.solve("klarbring")
        with self.assertRaisesRegex(ValueError, 'under "model"'):
            arcslip.solve(model.request()["model"])
        with self.assertRaisesRegex(ValueError, "explore"):
            arcslip.solve(model, explore={"depth": 1, "max_jobs": 1})
        for wrong in ("127.0.0.1:8080", "htp://x", ""):
            with self.assertRaisesRegex(ValueError, "address"):
                arcslip.Client(wrong)

    def test_numbers_that_json_cannot_hold_are_told_with_their_place(self):
        model = arcslip.Model(2)
        model.nodes({"a/b": (0, float("nan"))})
        model.stage("push", {"a/b": [0, float("inf")]})
        with self.assertRaises(arcslip.InvalidModel) as refused:
            arcslip.solve(model)
        pointers = [mistake.pointer for mistake in refused.exception.mistakes]
        self.assertEqual(pointers, ["/model/nodes/a~1b/1", "/model/stages/0/forces/a~1b/1"])

    def test_one_value_or_one_for_each(self):
        model = arcslip.Model(2)
        model.nodes([(0, 0), (1, 0), (2, 0)])
        model.bars(((place, place + 1) for place in range(2)), (k for k in (1.0, 2.0)), prestress=[3, 4], name=["p", "q"])
        own = [(bar["axial_stiffness"], bar["prestress"], bar["name"]) for bar in model.request()["model"]["elements"]]
        self.assertEqual(own, [(1.0, 3, "p"), (2.0, 4, "q")])

    def test_places_name_nodes_wherever_nodes_are_named(self):
        model = arcslip.Model(2)
        model.nodes([(0, 0), (1, 0)])
        model.stage("push", {1: (1, 0)}, until={"displacement": {"node": 1, "component": "x", "above": 1}})
        request = model.request(record={"nodes": [0], "supports": "all"})
        self.assertEqual(request["model"]["stages"][0]["until"]["displacement"]["node"], "n1")
        self.assertEqual(request["analysis"]["record"], {"nodes": ["n0"], "supports": "all"})

    def test_paths_without_increments_say_so(self):
        path = arcslip.Path(arcslip.Model(2).request(), [])
        for call in (path.largest_displacement, path.to_meshio if meshio else path.largest_displacement):
            with self.assertRaises(ValueError):
                call()
        with self.assertRaisesRegex(KeyError, "no increments"):
            path.column("load_factor")

    def test_values_by_pointer(self):
        document = {"a/b": [{"~": 1}]}
        self.assertEqual(value_at(document, "/a~1b/0/~0"), 1)
        self.assertIsNone(value_at(document, "/a~1b/1"))
        self.assertIsNone(value_at(document, "/c"))

    def test_every_part_of_a_solid(self):
        model = arcslip.Model(2)
        model.nodes([(0, 0), (1, 0), (1, 1), (0, 1)])
        model.material("rubber", "neo_hookean", young=2, poisson=0.4)
        self.assertEqual(model.solids("quadrilateral4", [(0, 1, 2, 3)], "rubber", plane="strain"), [0])
        model.surface("top", [(2, 3)])
        model.node_set("foot", [0, 1])
        model.support("@foot", "y")
        model.plane("floor", (0, 0), (0, 1))
        model.contact("@foot", "floor", 0.3)
        model.contact(surface="top", obstacle="floor")
        model.stage("blow", body_forces={"rubber": (0, -1)}, tractions={"top": (1, 0)}, pressures={"top": 0.1})
        request = model.request()["model"]
        self.assertEqual(request["materials"], {"rubber": {"kind": "neo_hookean", "young": 2, "poisson": 0.4}})
        self.assertEqual(request["elements"], [{
            "kind": "quadrilateral4", "nodes": ["n0", "n1", "n2", "n3"], "material": "rubber", "plane": "strain"}])
        self.assertEqual(request["surfaces"], {"top": {"faces": [["n2", "n3"]]}})
        self.assertEqual(request["sets"], {"foot": {"nodes": ["n0", "n1"]}})
        self.assertEqual(request["supports"], {"@foot": ["y"]})
        self.assertEqual([list(contact)[0] for contact in request["contacts"]], ["node", "surface"])
        self.assertEqual(request["stages"], [{
            "name": "blow", "body_forces": {"rubber": [0, -1]}, "tractions": {"top": [1, 0]}, "pressures": {"top": 0.1}}])
        for wrong in (lambda: model.surface("both"), lambda: model.contact(0, "floor", surface="top"), lambda: model.contact(0)):
            self.assertRaises(ValueError, wrong)

    def test_bodies_touch_each_other(self):
        model = arcslip.Model(2)
        for name, place in {"a": (0, 0), "b": (1, 0), "tip": (0, 1)}.items():
            model.node(name, *place)
        model.bar("a", "b", 1.0)
        model.surface("string", [["a", "b"]])
        model.surface("other", [["b", "a"]])
        model.contact(surface="other", against="string", friction=0.2)
        model.contact("tip", against="string", discretisation="node_to_surface")
        model.contact("a", surface="string", against="other")
        self.assertEqual(model.request()["model"]["contacts"], [
            {"surface": "other", "against": "string", "friction": 0.2},
            {"node": "tip", "against": "string", "discretisation": "node_to_surface", "friction": 0.0},
            {"node": "a", "surface": "string", "against": "other", "friction": 0.0},
        ])
        with self.assertRaisesRegex(ValueError, "with an obstacle, or against"):
            model.contact("tip", "floor", against="string")
        with self.assertRaisesRegex(ValueError, "with an obstacle, or against"):
            model.contact("tip")

    def test_a_mesh_file_goes_into_the_request(self):
        with tempfile.TemporaryDirectory() as folder:
            text, binary = pathlib.Path(folder) / "a.inp", pathlib.Path(folder) / "b.msh"
            text.write_text("*NODE\n1, 0, 0\n")
            binary.write_bytes(b"$MeshFormat\n\xff\xfe")
            model = arcslip.Model(2)
            model.mesh(text, "abaqus")
            model.group("body", "rubber", plane="stress")
            model.surface("rim", group="edge 3")
            request = model.request()["model"]
            self.assertEqual(request["mesh"], {"format": "abaqus", "content": "*NODE\n1, 0, 0\n"})
            self.assertEqual(request["elements"], [
                {"kind": "solid", "group": "body", "material": "rubber", "plane": "stress"}])
            self.assertEqual(request["surfaces"], {"rim": {"group": "edge 3"}})
            model.mesh(binary)
            mesh = model.request()["model"]["mesh"]
            self.assertEqual(base64.b64decode(mesh["content"]), b"$MeshFormat\n\xff\xfe")
            self.assertEqual(mesh["encoding"], "base64")

    @unittest.skipIf(numpy is None, "numpy and meshio are not installed")
    def test_solids_of_a_mesh_with_its_groups(self):
        points = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [9, 9, 0]], dtype=float)
        cells = [("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]]), ("line", [[0, 1], [1, 4]])]
        mesh = meshio.Mesh(
            points, [(kind, numpy.array(rows)) for kind, rows in cells],
            cell_sets={"left": [numpy.array([0]), None, None], "floor": [None, None, numpy.array([0, 1])]},
            point_sets={"pin": numpy.array([0, 5])},
        )
        request = arcslip.Model.from_meshio(mesh, material="matter", plane="strain").request()["model"]
        self.assertEqual((request["dimension"], len(request["nodes"])), (2, 5))
        self.assertEqual([element["kind"] for element in request["elements"]], ["quadrilateral4", "triangle3"])
        self.assertEqual(request["elements"][1], {"kind": "triangle3", "nodes": ["n1", "n4", "n2"], "material": "matter",
                                                  "name": "e1", "plane": "strain"})
        self.assertEqual(request["surfaces"], {"floor": {"faces": [["n0", "n1"], ["n1", "n4"]]}})
        self.assertEqual(request["sets"], {"left": {"elements": ["e0"]}, "pin": {"nodes": ["n0"]}})
        tagged = meshio.Mesh(
            points, [(kind, numpy.array(rows)) for kind, rows in cells],
            cell_data={"gmsh:physical": [numpy.array([7]), numpy.array([7]), numpy.array([8, 9])]},
            field_data={"body": numpy.array([7, 2]), "low": numpy.array([8, 1])},
        )
        request = arcslip.Model.from_meshio(tagged, material="matter", plane="strain").request()["model"]
        self.assertEqual(request["surfaces"], {"low": {"faces": [["n0", "n1"]]}})
        self.assertEqual(request["sets"], {"body": {"elements": ["e0", "e1"]}})
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "bar.vtu")
            meshio.write(file, meshio.Mesh(points[:2], [("line", numpy.array([[0, 1]]))]))
            self.assertEqual(len(arcslip.Model.from_meshio(file, 3.0).request()["model"]["elements"]), 1)
        with self.assertRaisesRegex(ValueError, "either"):
            arcslip.Model.from_meshio(mesh)
        with self.assertRaisesRegex(ValueError, "no triangles"):
            arcslip.Model.from_meshio(meshio.Mesh(points, [("line", numpy.array([[0, 1]]))]), material="matter")

    @unittest.skipIf(numpy is None, "numpy and meshio are not installed")
    def test_arrays_and_meshes(self):
        points = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
        lines = numpy.array([[0, 1], [1, 2]])
        mesh = meshio.Mesh(points, [("line", lines), ("vertex", numpy.array([[0]]))])
        model = arcslip.Model.from_meshio(mesh, axial_stiffness=numpy.array([1.0, 2.0]))
        model.support(numpy.int64(0))
        model.stage("push", {2: numpy.array([0.0, -1.0])})
        request = model.request(max_increments=numpy.int64(3))
        self.assertEqual(request["model"]["nodes"], {"n0": [0, 0], "n1": [1, 0], "n2": [0, 1]})
        self.assertEqual([bar["axial_stiffness"] for bar in request["model"]["elements"]], [1.0, 2.0])
        self.assertEqual(request["model"]["supports"], {"n0": ["x", "y"]})
        self.assertEqual(request["analysis"]["max_increments"], 3)
        model.to_json()
        mixed = meshio.Mesh(points, [("line", lines), ("triangle", numpy.array([[0, 1, 2]]))],
                            cell_data={"EA": [numpy.array([3.0, 4.0]), numpy.array([0.0])]})
        bars = arcslip.Model.from_meshio(mixed, "EA", ignore_others=True).request()["model"]["elements"]
        self.assertEqual([bar["axial_stiffness"] for bar in bars], [3.0, 4.0])
        json.dumps(arcslip.Model(numpy.int64(2)).request())
        in_space = arcslip.Model.from_meshio(meshio.Mesh(points + [0, 0, 1.0], [("line", lines)]), 1.0)
        self.assertEqual(in_space.dimension, 3)
        with self.assertRaisesRegex(ValueError, "triangle"):
            arcslip.Model.from_meshio(meshio.Mesh(points, [("triangle", numpy.array([[0, 1, 2]]))]), 1.0)


if __name__ == "__main__":
    unittest.main()
