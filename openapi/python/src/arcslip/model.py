"""Builds requests: what `POST /v1/jobs` and `arcslip solve` take."""

from __future__ import annotations

import base64
import copy
import difflib
import json
import numbers
import os
import pathlib
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Union

#: Anything that holds numbers in order: a list, a tuple, an array of numpy.
Vector = Sequence[float]
#: A node by its name, or by its place among the nodes, from 0.
Node = Union[str, int]


def plain(value: Any) -> Any:
    """The value with lists in place of tuples and of numpy's arrays, and Python's numbers in place of numpy's."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


class Model:
    """A model that grows call by call. Nodes that are given by their place are looked up at once; the program checks the
    whole, names included.

    `dimension` is 2 or 3. Quantities are in any consistent units; `units` labels axes and tables, such as
    `{"length": "m", "force": "kN"}`.
    """

    def __init__(self, dimension: int, name: Optional[str] = None, units: Optional[Mapping[str, str]] = None):
        if dimension not in (2, 3):
            raise ValueError(f"the dimension is 2 or 3, not {dimension!r}")
        self.dimension = int(dimension)
        self.name = name
        if units is not None and not isinstance(units, Mapping):
            raise TypeError(f'units are labels by name, such as {{"length": "m", "force": "kN"}}; found {units!r}')
        self.units = None if units is None else dict(units)
        self._nodes: Dict[str, List[float]] = {}
        self._names: List[str] = []
        self._supports: Dict[str, List[str]] = {}
        self._mesh: Optional[Dict[str, str]] = None
        self._materials: Dict[str, Dict[str, Any]] = {}
        self._surfaces: Dict[str, Dict[str, Any]] = {}
        self._sets: Dict[str, Dict[str, Any]] = {}
        self._elements: List[Dict[str, Any]] = []
        self._obstacles: Dict[str, Dict[str, Any]] = {}
        self._contacts: List[Dict[str, Any]] = []
        self._stages: List[Dict[str, Any]] = []

    # Nodes ------------------------------------------------------------------------------------------------------------

    def node(self, name: str, *coordinates: Union[float, Vector]) -> str:
        """Adds a node from its coordinates, or one list or array of them; returns its name."""
        if name in self._nodes:
            raise ValueError(f"there is a node {name!r} already")
        values = plain(coordinates[0]) if len(coordinates) == 1 and not is_number(coordinates[0]) else plain(coordinates)
        if not isinstance(values, list) or len(values) != self.dimension:
            raise ValueError(f"node {name!r}: {self.dimension} coordinates are expected, found {values!r}")
        self._nodes[name] = [float(value) for value in values]
        self._names.append(name)
        return name

    def nodes(self, coordinates: Union[Mapping[str, Vector], Iterable[Vector]], prefix: str = "n") -> List[str]:
        """Adds nodes from a dict by name, or from an array with a row for each; returns their names.

        Rows are named by their place among all nodes: `n0`, `n1` and so on.
        """
        if isinstance(coordinates, Mapping):
            return [self.node(str(name), row) for name, row in coordinates.items()]
        first = len(self._nodes)
        return [self.node(f"{prefix}{first + place}", row) for place, row in enumerate(coordinates)]

    def support(self, nodes: Union[Node, Iterable[Node]], components: Union[str, Iterable[str]] = "") -> None:
        """Holds components such as `"xy"` of a node or of several; all displacements unless given. In the plane
        `["x", "y", "rz"]` holds the rotation of a beam's node, too; in space there are `rx`, `ry` and `rz`."""
        known = ["x", "y", "z", "rx", "ry", "rz"] if self.dimension == 3 else ["x", "y", "rz"]
        held = [components] if components in known else list(components) or list("xyz"[: self.dimension])
        unknown = [component for component in held if component not in known]
        if unknown:
            # A word such as "fixed" is no list of components.
            given = components if isinstance(components, str) and len(components) > 3 else unknown[0]
            raise ValueError(f"{given!r} is no component; known are {', '.join(known)}, and all displacements without any")
        several = [nodes] if isinstance(nodes, str) or not isinstance(nodes, Iterable) else nodes
        for node in several:
            own = self._supports.setdefault(self.node_name(node), [])
            own.extend(component for component in held if component not in own)

    def node_name(self, node: Node) -> str:
        """The name of a node that is given by its name or its place."""
        if isinstance(node, str):
            return node
        # Booleans are whole numbers to Python, and a mask of nodes is not a list of places.
        if not isinstance(node, numbers.Integral) or isinstance(node, bool):
            raise TypeError(f"a node is named by its name or its place, a whole number; found {node!r}")
        if not -len(self._names) <= int(node) < len(self._names):
            raise IndexError(f"there is no node {node}; the model has {len(self._names)}")
        return self._names[int(node)]

    # Elements ---------------------------------------------------------------------------------------------------------

    def bar(self, first: Node, second: Node, axial_stiffness: Optional[float] = None, **more: Any) -> int:
        """Adds a bar with the axial stiffness EA, which is required; returns its place among the elements.

        `more`: `rest_length`, `prestress`, `strain` (`"engineering"`, `"green"`, `"log"`), `name`.
        """
        if axial_stiffness is None:
            found = f", and {', '.join(map(repr, more))} is none" if more else ""
            raise TypeError(f"a bar needs its axial stiffness EA, Young's modulus times area: axial_stiffness=...{found}")
        nodes = [self.node_name(first), self.node_name(second)]
        return self._element({"kind": "bar", "nodes": nodes, "axial_stiffness": plain(axial_stiffness), **plain(more)})

    def bars(self, pairs: Iterable[Sequence[Node]], axial_stiffness: Union[float, Vector, None] = None, **more: Any) -> List[int]:
        """Adds bars from pairs of nodes, by name or by place. `axial_stiffness`, and each of the other members, is one
        value for all of them, or a list or an array with one for each."""
        if axial_stiffness is None:
            raise TypeError("bars need their axial stiffness EA, Young's modulus times area: axial_stiffness=...")
        joined = [plain(list(pair)) if not hasattr(pair, "tolist") else pair.tolist() for pair in pairs]
        for pair in joined:
            if not isinstance(pair, list) or len(pair) != 2:
                raise ValueError(f"a bar joins a pair of nodes; found {pair!r}")
        members = {"axial_stiffness": axial_stiffness, **more}
        columns = {name: one_for_each(name, value, len(joined)) for name, value in members.items()}
        own = [{name: column[place] for name, column in columns.items()} for place in range(len(joined))]
        return [self.bar(first, second, **members) for (first, second), members in zip(joined, own)]

    def spring(self, first: Node, second: Optional[Node] = None, *, stiffness: Any, **more: Any) -> int:
        """Adds a spring between two nodes, or between one and the ground; returns its place among the elements.

        `stiffness` is a symmetric matrix, or one number for the same stiffness in every direction.
        """
        matrix = plain(stiffness)
        if is_number(matrix):
            matrix = [[matrix if row == column else 0.0 for column in range(self.dimension)] for row in range(self.dimension)]
        nodes = [self.node_name(node) for node in (first, second) if node is not None]
        return self._element({"kind": "spring", "nodes": nodes, "stiffness": matrix, **plain(more)})

    def beam(
        self, nodes: Sequence[Node], axial_stiffness: float, bending_stiffness: Union[float, Vector], **more: Any
    ) -> int:
        """Adds a beam along two or three nodes, with the stiffnesses EA and EI; returns its place among the elements.

        In space `bending_stiffness` is two numbers, about axes 1 and 2, and `torsional_stiffness` and `orientation`, a
        vector whose part across the beam is axis 1, are required.

        `more`: `shear_stiffness`, in the plane `releases` (such as `{"knee": ["rz"]}`), `name`.
        """
        named = [self.node_name(node) for node in nodes]
        own = {"axial_stiffness": axial_stiffness, "bending_stiffness": bending_stiffness, **more}
        return self._element({"kind": "beam", "nodes": named, **plain(own)})

    # Solids -----------------------------------------------------------------------------------------------------------

    def material(self, name: str, kind: str, **constants: float) -> str:
        """Adds a material of solids: `"linear_elastic"`, `"saint_venant_kirchhoff"` or `"neo_hookean"` with `young` and
        `poisson`, or `"mooney_rivlin"` with `c10`, `c01` and `bulk_modulus`."""
        if name in self._materials:
            raise ValueError(f"there is a material {name!r} already")
        self._materials[name] = {"kind": kind, **plain(constants)}
        return name

    def solid(self, kind: str, nodes: Sequence[Node], material: str, **more: Any) -> int:
        """Adds a solid such as `"quadrilateral4"` through nodes in the order of VTK; returns its place among the elements.

        `more`: in the plane `plane` (`"strain"`, `"stress"`, `"axisymmetric"`) and `thickness`; `locking`, `name`.
        """
        named = [self.node_name(node) for node in plain(nodes)]
        return self._element({"kind": kind, "nodes": named, "material": material, **plain(more)})

    def solids(self, kind: str, rows: Iterable[Sequence[Node]], material: str, **more: Any) -> List[int]:
        """Adds solids of one kind from a row of nodes for each, by name or by place."""
        return [self.solid(kind, row, material, **more) for row in rows]

    def mesh(self, file: Union[str, "pathlib.Path"], format: Optional[str] = None) -> None:
        """Takes a mesh file of gmsh or a deck of Abaqus into the request; `group` makes solids of its elements. Its sets
        and surfaces have their names there: `model.support("@foot", "y")`."""
        bytes_of_file = pathlib.Path(file).read_bytes()
        self._mesh = {} if format is None else {"format": format}
        try:
            self._mesh["content"] = bytes_of_file.decode("utf-8")
        except UnicodeDecodeError:
            self._mesh.update(content=base64.b64encode(bytes_of_file).decode("ascii"), encoding="base64")

    def group(self, group: Optional[str] = None, material: Optional[str] = None, **more: Any) -> None:
        """Makes solids of the elements of a group of the mesh, or of all of them; `more` as in `solid`. What is left out
        is what the file says."""
        own = {name: value for name, value in (("group", group), ("material", material)) if value is not None}
        self._elements.append({"kind": "solid", **own, **plain(more)})

    def surface(self, name: str, faces: Optional[Iterable[Sequence[Node]]] = None, group: Optional[str] = None) -> str:
        """Names faces of solids, each by its nodes, or a group of faces of the mesh."""
        if (faces is None) == (group is None):
            raise ValueError(f"surface {name!r}: either faces or a group of the mesh is expected")
        if faces is None:
            self._surfaces[name] = {"group": group}
        else:
            self._surfaces[name] = {"faces": [[self.node_name(node) for node in plain(face)] for face in plain(faces)]}
        return name

    def node_set(self, name: str, nodes: Iterable[Node]) -> str:
        """Names nodes: `"@name"` stands for them."""
        self._sets[name] = {"nodes": [self.node_name(node) for node in plain(nodes)]}
        return name

    def _element(self, element: Dict[str, Any]) -> int:
        self._elements.append(element)
        return len(self._elements) - 1

    # Contacts ---------------------------------------------------------------------------------------------------------

    def plane(self, name: str, point: Vector, normal: Vector) -> str:
        """Adds a half-space as obstacle; `normal` points into its free side, and need not have unit length."""
        return self._obstacle(name, {"kind": "plane", "point": plain(point), "normal": plain(normal)})

    def ball(self, name: str, center: Vector, radius: float, side: str = "outside") -> str:
        """Adds a circle or sphere as obstacle; nodes stay `"outside"` or `"inside"` of it."""
        return self._obstacle(name, {"kind": "ball", "center": plain(center), "radius": plain(radius), "side": side})

    def cylinder(self, name: str, point: Vector, axis: Vector, radius: float, side: str = "outside") -> str:
        """Adds a circular cylinder in space about the line through a point along an axis; nodes stay `"outside"` or
        `"inside"` of it."""
        obstacle = {"kind": "cylinder", "point": plain(point), "axis": plain(axis), "radius": plain(radius), "side": side}
        return self._obstacle(name, obstacle)

    def polyline(
        self,
        name: str,
        points: Sequence[Vector],
        *,
        closed: bool = False,
        rounding: Optional[float] = None,
        side: Optional[str] = None,
        section: Optional[Mapping[str, Vector]] = None,
    ) -> str:
        """Adds a curve in the plane as obstacle: the cubic spline through points, or with a `rounding` straight edges
        with corners rounded off within that length. An open one is free to the left of its direction; of a closed one
        nodes stay `"outside"` or `"inside"`. In space the points lie in the plane of a `section`,
        `{"origin": (0, 0, 0), "x": (1, 0, 0), "y": (0, 0, 1)}`, and the obstacle is straight across it."""
        obstacle: Dict[str, Any] = {"kind": "polyline", "points": plain(points), "closed": closed}
        if rounding is not None:
            obstacle["rounding"] = plain(rounding)
        if side is not None:
            obstacle["side"] = side
        if section is not None:
            obstacle["section"] = {name: plain(value) for name, value in section.items()}
        return self._obstacle(name, obstacle)

    def box(
        self,
        name: str,
        center: Vector,
        size: Vector,
        *,
        rounding: Optional[float] = None,
        side: str = "outside",
        x: Optional[Vector] = None,
        y: Optional[Vector] = None,
    ) -> str:
        """Adds a rectangle in the plane or a cuboid in space as obstacle, with its sides' lengths from face to face and
        edges rounded from this distance on (a twentieth of the shortest side when absent); nodes stay `"outside"` or
        `"inside"` of it. `x` is along its first side, and in space `y` towards its second one; along the axes when
        absent."""
        obstacle: Dict[str, Any] = {"kind": "box", "center": plain(center), "size": plain(size), "side": side}
        for key, value in (("rounding", rounding), ("x", x), ("y", y)):
            if value is not None:
                obstacle[key] = plain(value)
        return self._obstacle(name, obstacle)

    def triangle_mesh(
        self,
        name: str,
        points: Any,
        triangles: Optional[Sequence[Sequence[int]]] = None,
        *,
        rounding: float,
        side: str = "outside",
    ) -> str:
        """Adds the polyhedron that triangles enclose in space as obstacle, with edges rounded from this distance on. The
        triangles are the numbers of three points each, counted from 0; each of their sides belongs to two of them. In
        place of `points` and `triangles` there may be a mesh of meshio, or a file that meshio reads, such as STL. Nodes
        stay `"outside"` or `"inside"` of it."""
        if triangles is None:
            mesh = _mesh_of(points)
            found = [row for block in mesh.cells if block.type == "triangle" for row in plain(block.data)]
            if not found:
                raise ValueError("the mesh has no cells `triangle`")
            points, triangles = mesh.points, found
        obstacle = {
            "kind": "triangle_mesh",
            "points": plain(points),
            "triangles": plain(triangles),
            "rounding": plain(rounding),
            "side": side,
        }
        return self._obstacle(name, obstacle)

    def _obstacle(self, name: str, obstacle: Dict[str, Any]) -> str:
        if name in self._obstacles:
            raise ValueError(f"there is an obstacle {name!r} already")
        self._obstacles[name] = obstacle
        return name

    def contact(
        self,
        node: Optional[Node] = None,
        obstacle: str = "",
        friction: float = 0.0,
        *,
        surface: Optional[str] = None,
        against: Optional[str] = None,
        discretisation: Optional[str] = None,
        **more: Any,
    ) -> int:
        """Adds a contact of a node, of the nodes of a set (`"@name"`), or of a surface, with an obstacle or `against` the
        surface of another body (`discretisation`: "mortar" or "node_to_surface"); returns its place among the contacts."""
        for name in more:
            near = {"mu": "friction", "coefficient": "friction"}.get(name) or next(
                iter(difflib.get_close_matches(name, ("node", "obstacle", "friction", "surface", "against", "discretisation"), 1)), None
            )
            raise TypeError(f"a contact has no {name!r}" + (f"; did you mean {near!r}?" if near else ""))
        if against is None and node is not None and surface is not None:
            raise ValueError("a contact has either a node or a surface")
        if bool(obstacle) == (against is not None):
            raise ValueError("a contact is with an obstacle, or against a surface")
        contact: Dict[str, Any] = {}
        if node is not None or surface is None:
            contact["node"] = self.node_name(node)  # type: ignore[arg-type]
        if surface is not None:
            contact["surface"] = surface
        if against is not None:
            contact["against"] = against
            if discretisation is not None:
                contact["discretisation"] = discretisation
        else:
            contact["obstacle"] = obstacle
        contact["friction"] = plain(friction)
        self._contacts.append(contact)
        return len(self._contacts) - 1

    # Stages -----------------------------------------------------------------------------------------------------------

    def stage(
        self,
        name: str,
        forces: Optional[Mapping[Node, Vector]] = None,
        displacements: Optional[Mapping[Node, Vector]] = None,
        obstacle_motion: Optional[Mapping[str, Vector]] = None,
        until: Optional[Mapping[str, Any]] = None,
        moments: Optional[Mapping[Node, float]] = None,
        body_forces: Optional[Mapping[str, Vector]] = None,
        tractions: Optional[Mapping[str, Vector]] = None,
        pressures: Optional[Mapping[str, float]] = None,
        control: Optional[str] = None,
        history: Optional[Sequence[float]] = None,
        cycles: Optional[int] = None,
        obstacle_rotation: Optional[Mapping[str, Mapping[str, Any]]] = None,
    ) -> str:
        """Adds a stage: loads by node, `body_forces` by material, `tractions` and `pressures` by surface. Its pattern is multiplied by the load factor, which begins at 0; `until` says where it ends,
        such as `{"load_above": 1}` or `{"displacement": {"node": "tip", "component": "y", "below": -0.2}}`. With `control="load"`
        the load goes one way, or through `history` as often as `cycles` says, and the structure jumps where it must.
        `obstacle_rotation` turns obstacles, such as `{"drum": {"angle": 0.5}}` (radians), with `about` and in space `axis`."""
        stage: Dict[str, Any] = {"name": name}
        for key, pattern in (("forces", forces), ("displacements", displacements)):
            if pattern is not None:
                if not isinstance(pattern, Mapping):
                    found = f"{pattern!r}"
                    shown = found if len(found) <= 80 else f"{found[:80]}..."
                    raise TypeError(f"{key} are a dict from nodes to vectors; found {shown}")
                stage[key] = {self.node_name(node): plain(vector) for node, vector in pattern.items()}
        if moments is not None:
            stage["moments"] = {self.node_name(node): plain(moment) for node, moment in moments.items()}
        on_solids = (("body_forces", body_forces), ("tractions", tractions), ("pressures", pressures))
        of_obstacles = (("obstacle_motion", obstacle_motion), ("obstacle_rotation", obstacle_rotation))
        for key, pattern_of_names in (*on_solids, *of_obstacles):
            if pattern_of_names is not None:
                stage[key] = plain(pattern_of_names)
        if until is not None:
            stage["until"] = self._with_names(plain(until), ("displacement", "node"))
        for key, value in (("control", control), ("history", history), ("cycles", cycles)):
            if value is not None:
                stage[key] = plain(value)
        self._stages.append(stage)
        return name

    # Out and in -------------------------------------------------------------------------------------------------------

    def request(self, **analysis: Any) -> Dict[str, Any]:
        """The request as it is posted; `analysis` has the settings, such as `max_increments=500`."""
        model: Dict[str, Any] = {"dimension": self.dimension}
        for key, value in (("name", self.name), ("units", self.units)):
            if value is not None:
                model[key] = value
        model.update(nodes=self._nodes, elements=self._elements, stages=self._stages)
        for key, members in (
            ("mesh", self._mesh), ("materials", self._materials), ("surfaces", self._surfaces), ("sets", self._sets),
            ("supports", self._supports), ("obstacles", self._obstacles), ("contacts", self._contacts),
        ):
            if members:
                model[key] = members
        request: Dict[str, Any] = {"model": copy.deepcopy(model)}
        if analysis:
            request["analysis"] = plain(analysis)
            for member in ("nodes", "supports"):
                self._with_names(request["analysis"], ("record", member))
        return request

    def _with_names(self, value: Any, steps: Sequence[str]) -> Any:
        """The value, in which the nodes at the end of the steps are named where they are given by their places."""
        inner = value
        for step in steps[:-1]:
            inner = inner.get(step) if isinstance(inner, dict) else None
        if isinstance(inner, dict) and steps[-1] in inner:
            nodes = inner[steps[-1]]
            if isinstance(nodes, list):
                inner[steps[-1]] = [self.node_name(node) for node in nodes]
            elif not isinstance(nodes, str):
                inner[steps[-1]] = self.node_name(nodes)
        return value

    def to_json(self, **analysis: Any) -> str:
        """The request as text."""
        return json.dumps(self.request(**analysis), indent=1)

    @classmethod
    def from_meshio(
        cls,
        mesh: Any,
        axial_stiffness: Union[float, Vector, str, None] = None,
        dimension: Optional[int] = None,
        prefix: str = "n",
        ignore_others: bool = False,
        *,
        material: Optional[str] = None,
        **more: Any,
    ) -> "Model":
        """A truss of the lines of a mesh of meshio, or of a file that meshio reads, or with `material` solids of its
        triangles, quadrilaterals, tetrahedra and hexahedra, whichever have the largest dimension; a node for each point.

        `axial_stiffness` is one number, one for each line, or the name of the mesh's cell data. Without `dimension`
        points that all lie in the plane z = 0 give a model in the plane. Cells of other kinds are refused, unless they
        are to be ignored. Of solids `more` is what `solid` takes, such as `plane="strain"`; named sets of points and
        cells, gmsh's physical groups among them, become sets and surfaces, and points of no cell are left out.
        """
        mesh = _mesh_of(mesh)
        if material is not None and axial_stiffness is None:
            return _solids_of(cls, mesh, dimension, prefix, material, more)
        if material is not None or axial_stiffness is None:
            raise ValueError("either an axial stiffness, of bars, or a material, of solids, is expected")
        if more:
            raise TypeError(f"bars of a mesh have no {sorted(more)[0]!r}")
        points = [list(map(float, row)) for row in plain(mesh.points)]
        if dimension is None:
            dimension = 3 if any(len(row) > 2 and row[2] != 0.0 for row in points) else 2
        model = cls(dimension)
        model.nodes(((row + [0.0] * 3)[:dimension] for row in points), prefix)
        others = sorted({block.type for block in mesh.cells} - {"line", "vertex"})
        if others and not ignore_others:
            raise ValueError(f"the mesh has cells {', '.join(others)}; lines alone can be bars; `ignore_others` leaves the others out")
        pairs = [pair for block in mesh.cells if block.type == "line" for pair in plain(block.data)]
        if not pairs:
            raise ValueError("the mesh has no cells `line`")
        if isinstance(axial_stiffness, str):
            if axial_stiffness not in mesh.cell_data:
                raise ValueError(f"the mesh has no cell data {axial_stiffness!r}; it has {sorted(mesh.cell_data)}")
            blocks = zip(mesh.cells, mesh.cell_data[axial_stiffness])
            axial_stiffness = [value for block, values in blocks if block.type == "line" for value in plain(values)]
        model.bars(pairs, axial_stiffness)
        return model

    def __repr__(self) -> str:
        counts = f"{len(self._nodes)} nodes, {len(self._elements)} elements, {len(self._contacts)} contacts"
        return f"<Model in {self.dimension}D: {counts}, stages {[stage['name'] for stage in self._stages]}>"


def _mesh_of(mesh: Any) -> Any:
    """A mesh of meshio as it is; of a file, what meshio reads."""
    if not isinstance(mesh, (str, os.PathLike)):
        return mesh
    import meshio

    try:
        return meshio.read(mesh)
    except SystemExit as error:
        # It ends the program where it finds what it does not know, such as texts in files for ParaView.
        raise ValueError(f"meshio cannot read {os.fspath(mesh)!r}") from error


#: Kinds of solids and the dimension of each, by the names of meshio.
SOLIDS = {
    "triangle": ("triangle3", 2), "triangle6": ("triangle6", 2), "quad": ("quadrilateral4", 2),
    "quad8": ("quadrilateral8", 2), "tetra": ("tetrahedron4", 3), "tetra10": ("tetrahedron10", 3),
    "hexahedron": ("hexahedron8", 3), "hexahedron20": ("hexahedron20", 3),
}


def _groups(mesh: Any) -> Dict[str, List[List[int]]]:
    """Named groups of cells: for each the places of its cells within each block of the mesh."""
    groups = {
        name: [[int(place) for place in plain(own)] if own is not None else [] for own in members]
        for name, members in mesh.cell_sets.items()
        if not name.startswith("gmsh:")
    }
    tags = mesh.cell_data.get("gmsh:physical")
    if tags is not None:
        own_dimension = {"vertex": 0, "line": 1, "line3": 1, **{kind: number for kind, (_, number) in SOLIDS.items()}}
        for name, (tag, dimension) in ((name, plain(data)) for name, data in mesh.field_data.items()):
            groups.setdefault(name, [
                [place for place, own in enumerate(plain(values)) if own == tag]
                if own_dimension.get(block.type) == dimension else []
                for block, values in zip(mesh.cells, tags)
            ])
    return groups


def _solids_of(
    cls: Any, mesh: Any, dimension: Optional[int], prefix: str, material: str, more: Mapping[str, Any]
) -> "Model":
    highest = max((SOLIDS[block.type][1] for block in mesh.cells if block.type in SOLIDS), default=0)
    if highest == 0:
        raise ValueError("the mesh has no triangles, quadrilaterals, tetrahedra or hexahedra")
    if dimension not in (None, highest):
        raise ValueError(f"the mesh has solids of {highest} dimensions, not {dimension}")
    cells = [plain(block.data) for block in mesh.cells]
    is_solid = [block.type in SOLIDS and SOLIDS[block.type][1] == highest for block in mesh.cells]
    used = {node for rows, solid in zip(cells, is_solid) if solid for row in rows for node in row}
    model: Model = cls(highest)
    names = {}
    for place, row in enumerate(plain(mesh.points)):
        if place in used:
            names[place] = model.node(f"{prefix}{place}", (list(map(float, row)) + [0.0] * 3)[:highest])
    places: Dict[Any, str] = {}
    for number, (block, rows, solid) in enumerate(zip(mesh.cells, cells, is_solid)):
        for place, row in enumerate(rows if solid else []):
            name = f"e{len(places)}"
            places[number, place] = name
            model.solid(SOLIDS[block.type][0], [names[node] for node in row], material, name=name, **more)
    faces_of_solids = {2: ("line", "line3"), 3: ("triangle", "triangle6", "quad", "quad8")}[highest]
    for name, members in _groups(mesh).items():
        chosen = [(number, place) for number, own in enumerate(members) for place in own]
        faces = [
            cells[number][place] for number, place in chosen
            if mesh.cells[number].type in faces_of_solids and all(node in used for node in cells[number][place])
        ]
        solids = [places[at] for at in chosen if at in places]
        if faces:
            model.surface(name, [[names[node] for node in face] for face in faces])
        elif solids:
            model._sets[name] = {"elements": solids}
    for name, points in mesh.point_sets.items():
        own = [names[int(node)] for node in plain(points) if int(node) in used]
        if own and name not in model._surfaces and name not in model._sets:
            model.node_set(name, own)
    return model


def is_number(value: Any) -> bool:
    return isinstance(value, numbers.Number)


def one_for_each(name: str, value: Any, count: int) -> List[Any]:
    """A list or an array with a value for each of so many, or one value for all of them."""
    if isinstance(value, str) or is_number(value):
        return [value] * count
    values = plain(value) if hasattr(value, "tolist") else list(value)
    if not isinstance(values, list):
        # An array without dimensions.
        return [values] * count
    if len(values) != count:
        raise ValueError(f"there are {count} bars and {len(values)} values of {name}")
    return values


def as_request(model: Union[Model, Mapping[str, Any]], analysis: Mapping[str, Any]) -> Dict[str, Any]:
    """The request of a model, or of a request in which settings are replaced."""
    if isinstance(model, Model):
        return model.request(**analysis)
    if not isinstance(model, Mapping):
        raise TypeError(
            f"a Model or a request, a dict, is expected; found {type(model).__name__}. `arcslip.scene(name)` gives the "
            "request of a built-in scene, `json.load(file)` that of a file"
        )
    request = dict(plain(model))
    if "model" not in request and "nodes" in request:
        raise ValueError('the members of a model belong under "model": {"model": {...}, "analysis": {...}}')
    if analysis:
        request["analysis"] = {**request.get("analysis", {}), **plain(analysis)}
    return request
