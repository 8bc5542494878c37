"""Paths by the program and by a service. ARCSLIP_PROGRAM names the program."""

import csv
import io
import json
import math
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request
import zipfile

import arcslip

try:
    import matplotlib

    matplotlib.use("Agg")
    import meshio
    import numpy
    import pandas
    import tqdm  # noqa: F401
except ImportError:
    matplotlib = None

ALL = unittest.skipIf(matplotlib is None, "the packages of `arcslip[all]` are not installed")


def block(friction=0.3):
    """A block that is pressed onto a floor and pulled by a spring: it slips from friction on, `u = (s - friction)/2`."""
    model = arcslip.Model(2, name="block", units={"length": "m", "force": "kN"})
    model.node("block", 0, 0)
    model.spring("block", stiffness=[[2, 0], [0, 0]])
    model.plane("floor", [0, 0], [0, 1])
    model.contact("block", "floor", friction)
    model.stage("press", {"block": [0, -1]}, until={"load_above": 1})
    model.stage("pull", {"block": [1, 0]}, until={"load_above": 2})
    return model


def without_time(increments):
    return [{**row, "diagnostics": {**row["diagnostics"], "elapsed_s": 0}} for row in increments]


def cantilever():
    """A beam of length 2 and bending stiffness 3 that its end moment rolls up to a half circle."""
    model = arcslip.Model(dimension=2)
    for name, place in (("wall", 0.0), ("middle", 1.0), ("tip", 2.0)):
        model.node(name, place, 0.0)
    model.support("wall", ["x", "y", "rz"])
    model.beam(["wall", "middle", "tip"], 100.0, 3.0)
    model.stage("roll", moments={"tip": 3.0 * math.pi / 2.0}, until={"load_above": 1})
    return model


def square():
    """A square of rubber whose surface a pressure presses all around: the stress inside is its negative."""
    model = arcslip.Model(2)
    model.nodes([(0, 0), (1, 0), (1, 1), (0, 1)])
    model.material("rubber", "neo_hookean", young=2, poisson=0.4)
    model.solid("quadrilateral4", [0, 1, 2, 3], "rubber", plane="strain", name="body")
    model.surface("rim", [(0, 1), (1, 2), (2, 3), (3, 0)])
    model.support(0, "xy")
    model.support(1, "y")
    model.stage("dive", pressures={"rim": 0.1}, until={"load_above": 1})
    return model


class Program(unittest.TestCase):
    def test_a_solid_has_the_pressure_around_it(self):
        path = arcslip.solve(square())
        self.assertAlmostEqual(path.column("elements/body.stress.xx")[-1], -0.1, delta=1e-12)
        self.assertAlmostEqual(path.column("elements/body.stress.xy")[-1], 0.0, delta=1e-12)
        self.assertGreater(path.column("elements/body.von_mises")[-1], 0.0)
        if matplotlib is not None:
            mesh = path.to_meshio()
            self.assertEqual([block.type for block in mesh.cells], ["quad"])
            self.assertEqual(mesh.cell_data["von_mises"][0][0], path.column("elements/body.von_mises")[-1])

    def test_a_beam_rolls_up(self):
        path = arcslip.solve(cantilever())
        self.assertAlmostEqual(path.column("tip.rz")[-1], math.pi, places=8)
        self.assertAlmostEqual(path.column("tip.y")[-1], 4.0 / math.pi, places=8)
        self.assertAlmostEqual(path.column("elements/0.start.bending_moment")[-1], 1.5 * math.pi, places=8)
        self.assertAlmostEqual(path.column("wall.reaction.rz")[-1], -1.5 * math.pi, places=8)
        if matplotlib:
            mesh = path.to_meshio()
            moments = [[end["bending_moment"] for end in state["ends"]] for state in path[-1]["elements"]]
            numpy.testing.assert_array_equal(mesh.cell_data["bending_moment"][0], moments)
        self.assertIn(path.largest_displacement(), ("tip.x", "tip.y"))

    def test_a_block_slips_where_it_must(self):
        seen = []
        path = arcslip.solve(block(), each=seen.append)
        self.assertEqual(path.stop_reason, "stages_completed")
        self.assertEqual(seen, path.increments)
        self.assertAlmostEqual(path[-1]["displacements"]["block"][0], (2 - 0.3) / 2, delta=1e-12)
        self.assertIn("block on floor: stick to slip", [increment["point"]["event"] for increment in path.events])
        self.assertEqual(path.report["increments"], path[-1]["index"])
        self.assertEqual(path.column("block.x")[-1], path[-1]["displacements"]["block"][0])
        with self.assertRaisesRegex(KeyError, "did you mean 'block.x'"):
            path.column("blok.x")
        with self.assertRaisesRegex(KeyError, "record="):
            path.column("elements/7.axial_force")
        self.assertEqual(path[1:3].increments, path.increments[1:3])
        self.assertIn("stages_completed", repr(path))

    def test_settings_replace_those_of_a_request(self):
        request = block().request(max_increments=7)
        path = arcslip.solve(request, arc_length={"max": 0.01})
        self.assertEqual((len(path), path.stop_reason), (8, "max_increments"))

    def test_mistakes_have_pointer_and_value(self):
        model = block(friction=-1)
        model.contact("blok", "floor", 0.2)
        with self.assertRaises(arcslip.InvalidModel) as refused:
            arcslip.solve(model)
        mistakes = refused.exception.mistakes
        self.assertIn(("/model/contacts/0/friction", -1), [(mistake.pointer, mistake.value) for mistake in mistakes])
        self.assertIn(("/model/contacts/1/node", "blok"), [(mistake.pointer, mistake.value) for mistake in mistakes])
        self.assertIn("did you mean `block`", str(refused.exception))
        self.assertIn("here: -1", str(refused.exception))

    def test_what_may_be_a_mistake_is_told(self):
        with self.assertWarnsRegex(arcslip.ModelWarning, "/model/contacts/0/friction: the coefficient 30"):
            arcslip.solve(block(friction=30), max_increments=1)
        with self.assertRaisesRegex(TypeError, "'mu'; did you mean 'friction'"):
            block().contact("block", mu=0.2)

    def test_a_mechanism_is_refused_with_its_reason(self):
        model = arcslip.Model(2)
        model.nodes({"a": (0, 0), "b": (1, 0)})
        model.support("a")
        model.bar("a", "b", 1.0)
        model.stage("push", {"b": (0, 1)})
        with self.assertRaises(arcslip.ArcslipError):
            arcslip.solve(model)

    def test_a_program_that_is_not_there(self):
        with self.assertRaisesRegex(arcslip.ProgramNotFound, "no-such-program"):
            arcslip.solve(block(), program="no-such-program")
        with self.assertRaises(arcslip.ProgramFailed):
            arcslip.solve(block(), program=sys.executable)

    def test_an_interrupted_caller_leaves_no_program_behind(self):
        def stop(increment):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            arcslip.solve(arcslip.scene("one-bar-truss"), each=stop, max_increments=10_000_000)

    def test_rows_are_those_of_the_table(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("arch-type-truss", "curving-slip"):
                request = arcslip.scene(name)
                file = pathlib.Path(folder) / "path.csv"
                model = pathlib.Path(folder) / "model.json"
                model.write_text(json.dumps(request))
                subprocess.run([arcslip.find_program(), "solve", model, "--out", file], capture_output=True)
                path = arcslip.solve(request)
                with open(file, newline="") as table:
                    rows = list(csv.DictReader(table))
                self.assertEqual(len(rows), len(path))
                for row, increment in zip(rows, path):
                    own = path.row(increment)
                    for column, text in row.items():
                        value = own.get(column)
                        if column == "elapsed_s":
                            continue
                        if isinstance(value, float):
                            self.assertEqual(float(text), value, column)
                        elif isinstance(value, bool):
                            self.assertEqual(text, str(value).lower(), column)
                        else:
                            self.assertEqual(text, "" if value is None else str(value), column)

    def test_saved_and_loaded(self):
        path = arcslip.solve(block())
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "path.ndjson")
            path.save(file)
            self.assertEqual(arcslip.Path.load(file, path.request).increments, path.increments)
            with open(file, "a") as lines:
                lines.write('{"index": ')
            self.assertEqual(len(arcslip.Path.load(file, block())), len(path))
            for name in ("path.csv", "path.pvd", "path.parquet", "path.svg", "path.png"):
                path.save(os.path.join(folder, name))
            with open(os.path.join(folder, "path.csv"), newline="") as table:
                self.assertEqual(len(list(csv.DictReader(table))), len(path))
            self.assertEqual(len(list(pathlib.Path(folder, "path").glob("*.vtu"))), len(path))
            with self.assertRaisesRegex(ValueError, "'.xlsx' names no format of a path"):
                path.save(os.path.join(folder, "path.xlsx"))

    @ALL
    def test_tables_pictures_and_meshes(self):
        path = arcslip.solve(arcslip.scene("arch-type-truss"), progress=True)
        table = path.to_frame()
        self.assertIsInstance(table, pandas.DataFrame)
        self.assertEqual(list(table["load_factor"]), [increment["load_factor"] for increment in path])
        self.assertGreaterEqual(len(path.limit_points), 1)
        self.assertEqual(table.attrs["units"], {})
        request = arcslip.scene("arch-type-truss")
        request["model"]["units"] = {"length": "m", "force": "kN"}
        units = arcslip.solve(request)[:2].to_frame().attrs["units"]
        self.assertEqual((units["strain_energy"], units.get("load_factor")), ("kN m", None))
        self.assertIn("m", units.values())
        axes = path.plot()
        self.assertTrue(any(line.get_linestyle() == "--" for line in axes.lines) == any(
            here["load_factor"] < before["load_factor"] and before["point"]["bifurcation"]
            for before, here in zip(path, path[1:])))
        labels = axes.get_legend_handles_labels()[1]
        self.assertIn("smooth limit point", labels)
        self.assertEqual(len(labels), len(set(labels)))
        axes.figure.savefig(io.BytesIO(), format="svg")
        again = arcslip.solve(block()).plot("block.x")
        self.assertEqual(again.get_xlabel(), "block.x [m]")
        self.assertEqual(again.get_legend_handles_labels()[1][:2], ["press", "pull"])
        with self.assertRaisesRegex(ValueError, "no number"):
            path.plot("event")
        mesh = path.to_meshio()
        last = path[-1]
        for place, node in enumerate(path.request["model"]["nodes"]):
            numpy.testing.assert_array_equal(mesh.point_data["displacement"][place][:2], last["displacements"][node])
        axial = [state["axial_force"] for state in last["elements"] if "axial_force" in state]
        numpy.testing.assert_array_equal(mesh.cell_data["axial_force"][0], axial)
        nodes = list(path.request["model"]["nodes"])
        for contact in last["contacts"]:
            place = nodes.index(contact["node"])
            self.assertEqual(mesh.point_data["normal_reaction"][place], contact["normal_reaction"])
            numpy.testing.assert_array_equal(mesh.point_data["contact_reaction"][place][:2], contact["reaction"])
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "arch.vtu")
            meshio.write(file, mesh)
            self.assertEqual(len(meshio.read(file).points), len(mesh.points))


class Service(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            cls.port = free.getsockname()[1]
        cls.start()
        cls.client = arcslip.Client(f"http://127.0.0.1:{cls.port}", patience=60)

    @classmethod
    def start(cls):
        database = os.path.join(cls.folder.name, "jobs.db")
        command = [arcslip.find_program(), "serve", "--listen", f"127.0.0.1:{cls.port}", "--database", database]
        cls.server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while True:
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{cls.port}/readyz", timeout=5).close()
                return
            except OSError:
                if cls.server.poll() is not None:
                    raise
                time.sleep(0.1)

    @classmethod
    def stop(cls):
        cls.server.terminate()
        cls.server.wait()

    @classmethod
    def tearDownClass(cls):
        cls.stop()
        cls.folder.cleanup()

    def test_the_same_path_as_the_program(self):
        path = self.client.solve(block())
        self.assertEqual(without_time(path.increments), without_time(arcslip.solve(block()).increments))
        self.assertEqual(path.stop_reason, "stages_completed")
        self.assertEqual(path.request, block().request())

    def test_mistakes_have_pointer_and_value(self):
        with self.assertRaises(arcslip.InvalidModel) as refused:
            self.client.submit(block(friction=-1))
        self.assertEqual(refused.exception.mistakes[0][::2], ("/model/contacts/0/friction", -1))
        with self.assertRaises(arcslip.Refused) as refused:
            self.client.job("00000000-0000-7000-8000-000000000000")
        self.assertEqual(refused.exception.status, 404)

    def test_one_key_queues_one_job(self):
        one, other = (self.client.submit(block(), key="block-1") for _ in range(2))
        self.assertEqual(one.id, other.id)

    def test_a_stream_goes_on_through_a_restart(self):
        job = self.client.submit(self.client.scene("one-bar-truss"), max_increments=3000, arc_length={"max": 1e-4, "initial": 1e-4})
        indices = []
        for increment in job:
            indices.append(increment["index"])
            if len(indices) == 50:
                self.stop()
                self.start()
        self.assertEqual(indices, list(range(3001)))
        self.assertEqual([increment["index"] for increment in job.increments(after=2990)], list(range(2991, 3001)))

    def test_directions_are_followed_and_explored(self):
        job = self.client.submit(self.client.scene("klarbring"))
        path = job.path()
        index, place, _ = next(path.directions(taken=False))
        branch = job.follow(index, place, max_increments=5)
        self.assertLessEqual(len(branch.path()), 6)
        self.assertEqual([found.id for found in job.branches()], [branch.id])
        root = self.client.explore(self.client.scene("klarbring"), depth=1, max_jobs=3)
        root.wait()
        self.assertGreaterEqual(len(root.branches()), 1)

    def test_sweeps_and_studies(self):
        sweep = self.client.sweep(self.client.scene("arch-type-truss"), {"/model/contacts/0/friction": [0, 0.5]})
        self.assertEqual(sweep.wait(), "completed")
        rows = sweep.rows()
        self.assertEqual([row["values"] for row in rows], [[0], [0.5]])
        self.assertLess(rows[0]["first_limit"]["load_factor"], rows[1]["first_limit"]["load_factor"])
        self.assertEqual(len(sweep.jobs()), 2)
        study = self.client.study(self.client.scene("klarbring"), {"arc_lengths": [0.2, 0.1], "methods": ["auto"], "repeats": 1})
        self.assertEqual(study.wait(), "completed")
        self.assertEqual(len(study.report()["rows"]), 2)

    @ALL
    def test_curves(self):
        job = self.client.submit(self.client.scene("arch-type-truss"))
        path = job.path()
        limit = next(row["index"] for row in path.increments if row["point"]["kind"] == "smooth_limit")
        curve = job.limit_curve("/model/contacts/*/friction", [0, 1], step=0.25, increment=limit)
        self.assertEqual(curve.wait(), "completed")
        self.assertTrue(curve.report()["complete"])
        rows = curve.rows()
        self.assertEqual([row["value"] for row in rows][0], 0)
        self.assertEqual(sorted(row["place"] for row in rows), [row["place"] for row in rows])
        frame = curve.to_frame()
        self.assertEqual(len(frame), len(rows))
        self.assertIn("b2.y", frame)
        other = self.client.curve(self.client.scene("arch-type-truss"), "/model/contacts/*/friction", [0, 1], step=0.25)
        other.wait()
        self.assertEqual([row["load_factor"] for row in other.rows()], [row["load_factor"] for row in rows])
        with self.assertRaises(arcslip.InvalidModel):
            job.limit_curve("/model/contacts/*/friction", [1, 0])
        turning = self.client.curve(self.client.scene("curving-slip"), "/model/contacts/0/friction", [0.1, 0.9])
        turning.wait()
        with self.assertRaisesRegex(arcslip.JobFailed, "has no point"):
            turning.rows()

    @ALL
    def test_tables_of_sweeps(self):
        friction = {"/model/contacts/0/friction": numpy.array([0, 0.5])}
        responses = {"limit": {"at": "first_limit"}}
        with self.assertRaisesRegex(TypeError, "did you mean 'responses'"):
            self.client.sweep(self.client.scene("arch-type-truss"), friction, response=responses)
        sweep = self.client.sweep(self.client.scene("arch-type-truss"), friction, responses=responses)
        sweep.wait()
        table = sweep.to_frame()
        self.assertEqual(list(table["limit"]), list(table["limit.load_factor"]))
        self.assertEqual(list(table["/model/contacts/0/friction"]), [0, 0.5])
        self.assertTrue(all(math.isfinite(value) for value in table["limit.load_factor"]))

    def test_what_never_answers_is_given_up(self):
        for url in ("http://no-such-host.invalid:8080", "https" + self.client.url[4:]):
            with self.assertRaises(arcslip.Unreachable):
                arcslip.Client(url, patience=60).scene("klarbring")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            gone = arcslip.Client(f"http://127.0.0.1:{free.getsockname()[1]}", patience=0.1)
        with self.assertRaises(arcslip.Unreachable):
            gone.scene("klarbring")

    def test_a_request_that_is_too_large_is_told(self):
        request = block().request()
        request["model"]["name"] = "n" * (17 << 20)
        with self.assertRaises(arcslip.ArcslipError):
            self.client.submit(request)

    def test_cancelled_listed_downloaded_and_deleted(self):
        job = self.client.submit(self.client.scene("one-bar-truss"), max_increments=1_000_000, arc_length={"max": 1e-6, "initial": 1e-6})
        next(iter(job))
        job.cancel()
        self.assertEqual(job.wait(), "cancelled")
        self.assertIn(job.id, [found.id for found in self.client.jobs(status="cancelled")])
        files = zipfile.ZipFile(io.BytesIO(self.client.submit(block()).path() and next(self.client.jobs(status="completed")).download("results.pvd")))
        self.assertIn("path.pvd", files.namelist())
        job.delete()
        self.assertEqual(job.status, "deleted")
        with self.assertRaises(arcslip.Refused):
            self.client.job(job.id)

    def test_a_plan_says_what_may_be_a_mistake(self):
        plan = self.client.check(block(friction=30))
        self.assertEqual(plan["warnings"][0]["pointer"], "/model/contacts/0/friction")
        with self.assertWarns(arcslip.ModelWarning):
            self.client.submit(block(friction=30), max_increments=1)
        with self.assertWarnsRegex(arcslip.ModelWarning, "friction/1: .*unusually large"):
            self.client.sweep(block(), {"/model/contacts/0/friction": [0.3, 30]}, max_increments=1)


if __name__ == "__main__":
    unittest.main()
