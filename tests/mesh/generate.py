"""Generates the sample meshes in `samples`, and `summaries.json` with what other programs read in them.

Needs the Python packages gmsh and meshio: `python3 tests/mesh/generate.py`. The summaries hold, for every file, what
meshio reads (number of points, cells by kind in VTK's node order) and, for gmsh's files, the nodes of the physical
groups by gmsh itself. `places` weighs the coordinates by the place of the node in its cell, so that a wrong order of
nodes changes it; the sums need no order of the cells.
"""

import json
import pathlib
import struct

import gmsh
import meshio
import numpy

HERE = pathlib.Path(__file__).parent
SAMPLES = HERE / "samples"

PLANE = {"triangle3": (1, False), "triangle6": (2, False), "quadrilateral4": (1, True), "quadrilateral8": (2, True)}
SPACE = {"tetrahedron4": (1, False), "tetrahedron10": (2, False), "hexahedron8": (1, True), "hexahedron20": (2, True)}


def start(name):
    gmsh.clear()
    gmsh.model.add(name)
    for option in ("SaveAll", "SaveParametric", "Binary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)


def plane_model(order, quadrilaterals):
    geometry = gmsh.model.geo
    corners = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.25, 1.0), (1.0, 1.25), (-0.25, 1.0)]
    for number, (x, y) in enumerate(corners, start=1):
        geometry.addPoint(x, y, 0.0, 10.0, number)
    lines = [(1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1), (2, 5)]
    for number, (first, second) in enumerate(lines, start=1):
        geometry.addLine(first, second, number)
    geometry.addCurveLoop([1, 7, 5, 6], 1)
    geometry.addCurveLoop([2, 3, 4, -7], 2)
    for surface in (1, 2):
        geometry.addPlaneSurface([surface], surface)
    for curve in range(1, 8):
        geometry.mesh.setTransfiniteCurve(curve, 3)
    for surface in (1, 2):
        geometry.mesh.setTransfiniteSurface(surface)
        if quadrilaterals:
            geometry.mesh.setRecombine(2, surface)
    geometry.synchronize()
    gmsh.model.addPhysicalGroup(0, [1], 1, "pin")
    gmsh.model.addPhysicalGroup(1, [1, 2], 2, "lower edge")
    gmsh.model.addPhysicalGroup(1, [3], 7)
    gmsh.model.addPhysicalGroup(2, [1], 3, "left")
    gmsh.model.addPhysicalGroup(2, [2], 4, "right")
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)


def space_model(order, hexahedra):
    geometry = gmsh.model.geo
    for number, (x, y) in enumerate([(0.0, 0.0), (2.0, 0.0), (2.5, 1.0), (0.25, 1.25)], start=1):
        geometry.addPoint(x, y, 0.0, 10.0, number)
    for number in range(1, 5):
        geometry.addLine(number, number % 4 + 1, number)
        geometry.mesh.setTransfiniteCurve(number, 3 if number % 2 and hexahedra and order == 1 else 2)
    geometry.addCurveLoop([1, 2, 3, 4], 1)
    geometry.addPlaneSurface([1], 1)
    geometry.mesh.setTransfiniteSurface(1)
    if hexahedra:
        geometry.mesh.setRecombine(2, 1)
    swept = geometry.extrude([(2, 1)], 0.5, 0.25, 1.0, [1], recombine=hexahedra)
    geometry.synchronize()
    gmsh.model.addPhysicalGroup(0, [3], 5, "corner")
    gmsh.model.addPhysicalGroup(1, [1], 6, "front edge")
    gmsh.model.addPhysicalGroup(2, [1], 1, "bottom")
    gmsh.model.addPhysicalGroup(2, [swept[0][1]], 2, "top")
    gmsh.model.addPhysicalGroup(3, [swept[1][1]], 1, "body")
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)


def write(name, versions=(2.2, 4.1), encodings=(0, 1)):
    for version in versions:
        for binary in encodings:
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            kind = "binary" if binary else "text"
            gmsh.write(str(SAMPLES / f"{name}_{version * 10:.0f}_{kind}.msh"))


def special_models():
    start("overlapping")
    plane_model(1, True)
    gmsh.model.addPhysicalGroup(2, [1, 2], 9, "all")
    gmsh.model.addPhysicalGroup(1, [1, 7], 10, "lower left")
    write("overlapping", encodings=(0,))

    start("partitioned")
    plane_model(1, False)
    gmsh.option.setNumber("Mesh.PartitionCreateTopology", 1)
    gmsh.model.mesh.partition(2)
    write("partitioned")

    start("parametric")
    plane_model(1, True)
    gmsh.option.setNumber("Mesh.SaveParametric", 1)
    write("parametric", versions=(4.1,))

    start("ungrouped")
    plane_model(1, True)
    gmsh.model.removePhysicalGroups()
    write("ungrouped", encodings=(0,))

    start("periodic")
    plane_model(1, True)
    shift = [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    gmsh.model.mesh.clear()
    gmsh.model.mesh.setPeriodic(1, [2], [1], shift)
    gmsh.model.mesh.generate(2)
    write("periodic", versions=(4.1,))

    start("sparse")
    plane_model(1, True)
    tags = gmsh.model.mesh.getNodes()[0]
    gmsh.model.mesh.renumberNodes(tags, [int(tag) ** 3 * 1_000_003 for tag in tags])
    write("sparse", versions=(4.1,))

    start("clockwise")
    plane_model(2, True)
    gmsh.model.mesh.reverse([(2, 1)])
    write("clockwise", versions=(4.1,), encodings=(0,))


CUBE = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
NAMES = b'$PhysicalNames\n2\n2 1 "bottom"\n3 1 "body"\n$EndPhysicalNames\n'


def cube_22(order):
    """One hexahedron and its lower face in version 2.2, binary, in the given order of bytes."""
    text = b"$MeshFormat\n2.2 1 8\n" + struct.pack(order + "i", 1) + b"\n$EndMeshFormat\n" + NAMES + b"$Nodes\n8\n"
    for tag, point in enumerate(CUBE, start=1):
        text += struct.pack(order + "i3d", tag, *point)
    text += b"\n$EndNodes\n$Elements\n2\n"
    text += struct.pack(order + "3i", 3, 1, 2) + struct.pack(order + "7i", 1, 1, 1, 1, 2, 3, 4)
    text += struct.pack(order + "3i", 5, 1, 2) + struct.pack(order + "11i", 2, 1, 1, *range(1, 9))
    return text + b"\n$EndElements\n"


def cube_41(order, size="Q"):
    """The same in version 4.1, with counts and tags of 8 bytes (Q) or 4 (I)."""

    def pack(form, *values):
        return struct.pack(order + form.replace("Q", size), *values)

    text = b"$MeshFormat\n4.1 1 %d\n" % struct.calcsize(size) + pack("i", 1) + b"\n$EndMeshFormat\n"
    text += NAMES + b"$Entities\n" + pack("4Q", 0, 0, 1, 1)
    text += pack("i6dQiQ", 1, 0, 0, 0, 1, 1, 0, 1, 1, 0)
    text += pack("i6dQiQ", 1, 0, 0, 0, 1, 1, 1, 1, 1, 0) + b"\n$EndEntities\n$Nodes\n"
    text += pack("4Q", 1, 8, 1, 8) + pack("3iQ", 3, 1, 0, 8) + pack("8Q", *range(1, 9))
    text += b"".join(pack("3d", *point) for point in CUBE)
    text += b"\n$EndNodes\n$Elements\n" + pack("4Q", 2, 2, 1, 2)
    text += pack("3iQ", 2, 1, 3, 1) + pack("5Q", 1, 1, 2, 3, 4)
    text += pack("3iQ", 3, 1, 5, 1) + pack("9Q", 2, *range(1, 9))
    return text + b"\n$EndElements\n"


def write_cubes():
    for version, cube in (("22", cube_22), ("41", cube_41)):
        for order, name in (("<", "little"), (">", "big")):
            (SAMPLES / f"cube_{version}_{name}.msh").write_bytes(cube(order))
    (SAMPLES / "cube_41_narrow.msh").write_bytes(cube_41("<", "I"))


def rounded(values):
    return [round(float(value), 9) for value in values]


def cells(mesh):
    """For each kind of cell: its number, and the coordinates weighed by the place in the cell."""
    found = {}
    for block in mesh.cells:
        points = mesh.points[block.data]
        weights = numpy.arange(1, points.shape[1] + 1)
        entry = found.setdefault(block.type, {"count": 0, "places": numpy.zeros(points.shape[2])})
        # Squares, since a sum over shared nodes hides some permutations.
        entry["count"] += len(block.data)
        entry["places"] = entry["places"] + numpy.einsum("j,ijk->k", weights, (points + 3.0) ** 2)
    return {kind: {"count": entry["count"], "places": rounded(entry["places"])} for kind, entry in found.items()}


def groups(path):
    """For each physical group, by gmsh: its nodes' number and sums of coordinates."""
    gmsh.clear()
    gmsh.open(str(path))
    found = []
    for dimension, tag in gmsh.model.getPhysicalGroups():
        nodes, coordinates = gmsh.model.mesh.getNodesForPhysicalGroup(dimension, tag)
        coordinates = numpy.reshape(coordinates, (-1, 3))
        found.append(
            {
                "dimension": dimension,
                "tag": tag,
                "name": gmsh.model.getPhysicalName(dimension, tag),
                "nodes": len(nodes),
                "sums": rounded(coordinates.sum(axis=0)),
            }
        )
    return found


def summary(path):
    # meshio reads no parametric nodes of version 4.1, and no big-endian files: gmsh's twin has the same mesh.
    try:
        mesh = meshio.read(path)
        read = {"points": len(mesh.points), "cells": cells(mesh)}
    except (Exception, SystemExit) as error:
        print(f"{path.name}: not read by meshio: {error}")
        read = {}
    if path.suffix == ".msh":
        read["groups"] = groups(path)
    elif read:
        read["point_sets"] = {name: len(points) for name, points in mesh.point_sets.items()}
        read["cell_sets"] = {name: sum(len(part) for part in parts) for name, parts in mesh.cell_sets.items()}
    return read


def generated():
    decks = [SAMPLES / f"{name}.inp" for name in (*PLANE, *SPACE)]
    # gmsh reads sizes of its own machine alone.
    meshes = [path for path in SAMPLES.glob("*.msh") if path.name != "cube_41_narrow.msh"]
    return sorted([*meshes, *decks])


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    for model, kinds in ((plane_model, PLANE), (space_model, SPACE)):
        for name, (order, recombined) in kinds.items():
            start(name)
            model(order, recombined)
            write(name)
            gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
            deck = SAMPLES / f"{name}.inp"
            gmsh.write(str(deck))
            # The heading has the path of the file.
            deck.write_text(deck.read_text().replace(str(SAMPLES) + "/", ""))
    special_models()
    write_cubes()
    summaries = {path.name: summary(path) for path in generated()}
    gmsh.finalize()
    lines = [f" {json.dumps(name)}: {json.dumps(read)}" for name, read in summaries.items()]
    (HERE / "summaries.json").write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main()
