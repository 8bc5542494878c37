"""A path: its increments as lists, tables, pictures and meshes."""

from __future__ import annotations

import difflib
import json
import pathlib
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union, overload

from arcslip.model import SOLIDS, Model, as_request
from arcslip.picture import unit_of

Increment = Dict[str, Any]

AXES = "xyz"
#: Extensions of files that hold increments as lines, and of those that the program writes.
LINES = ("", ".ndjson", ".jsonl")
EXPORTED = (".csv", ".parquet", ".pvd", ".svg", ".png")
#: Names of solids' cells in meshio by their kinds.
CELLS = {kind: name for name, (kind, _) in SOLIDS.items()}


class Path:
    """The increments of a path, dicts as the manual's chapter *Results* describes them, with the request and the report."""

    def __init__(
        self,
        request: Mapping[str, Any],
        increments: Sequence[Increment],
        report: Optional[Mapping[str, Any]] = None,
        stop_reason: Optional[str] = None,
    ):
        self.request = dict(request)
        self.increments = list(increments)
        self.report = dict(report) if report else {}
        #: Why the path ended, such as `stages_completed`.
        self.stop_reason = stop_reason
        #: What tells a path that follows a direction of another one from that; empty for others.
        self.branch = ""

    def __len__(self) -> int:
        return len(self.increments)

    def __iter__(self) -> Iterator[Increment]:
        return iter(self.increments)

    @overload
    def __getitem__(self, place: int) -> Increment: ...

    @overload
    def __getitem__(self, place: slice) -> "Path": ...

    def __getitem__(self, place: Union[int, slice]) -> Any:
        """An increment, or a part of the path."""
        if isinstance(place, slice):
            part = Path(self.request, self.increments[place], self.report, self.stop_reason)
            part.branch = self.branch
            return part
        return self.increments[place]

    @property
    def events(self) -> List[Increment]:
        """The increments at which something happens."""
        return [increment for increment in self.increments if increment["point"]["kind"] != "regular"]

    @property
    def limit_points(self) -> List[Increment]:
        """The smooth and nonsmooth limit points."""
        kinds = ("smooth_limit", "nonsmooth_limit")
        return [increment for increment in self.increments if increment["point"]["kind"] in kinds]

    def directions(self, taken: Optional[bool] = None) -> Iterator[Tuple[int, int, Dict[str, Any]]]:
        """The feasible directions: index of the increment, place in its list, and the direction; those that the path
        takes, or does not take, where `taken` says so."""
        for increment in self.increments:
            for place, direction in enumerate(increment.get("directions") or []):
                if taken is None or direction["taken"] == taken:
                    yield increment["index"], place, direction

    # Quantities -------------------------------------------------------------------------------------------------------

    def row(self, increment: Increment) -> Dict[str, Any]:
        """The quantities of an increment by name: the columns of the CSV table."""
        axes = AXES[: self.dimension]
        row = {name: increment[name] for name in ("index", "stage", "load_factor", "arc_length", "step")}
        point = increment["point"]
        row.update(point=point["kind"], bifurcation=point["bifurcation"], event=point["event"])
        with_rotation = [*axes, "rx", "ry", "rz"] if self.dimension == 3 else [*axes, "rz"]
        for node, vector in increment["displacements"].items():
            row.update(zip((f"{node}.{axis}" for axis in with_rotation), vector))
        seen: Dict[str, int] = {}
        for contact in increment["contacts"]:
            own = f"{contact['node']}/{contact['obstacle']}"
            seen[own] = seen.get(own, 0) + 1
            if seen[own] > 1:
                own = f"{own}#{seen[own]}"
            for name, value in contact.items():
                if name in ("node", "obstacle"):
                    continue
                if isinstance(value, list):
                    ends = axes if name == "reaction" else range(1, len(value) + 1)
                    row.update(zip((f"{own}.{name}.{end}" for end in ends), value))
                else:
                    row[f"{own}.{name}"] = value
        for element in increment.get("elements") or []:
            own = f"elements/{element.get('name', element['element'])}"
            if "axial_force" in element:
                row[f"{own}.axial_force"] = element["axial_force"]
            if "force" in element:
                row.update(zip((f"{own}.force.{axis}" for axis in axes), element["force"]))
            for end, forces in zip(("start", "end"), element.get("ends") or []):
                for name, value in forces.items():
                    # In space there are two of some, which the table numbers.
                    if isinstance(value, list):
                        one = name[: -len("s")]
                        row.update((f"{own}.{end}.{one}.{axis}", part) for axis, part in enumerate(value, 1))
                    else:
                        row[f"{own}.{end}.{name}"] = value
            if "moment" in element:
                row[f"{own}.moment"] = element["moment"]
            if "stress" in element:
                components = ("xx", "yy", "zz", "xy", "yz", "xz")
                row.update((f"{own}.stress.{at}", value) for at, value in zip(components, element["stress"]))
                row[f"{own}.von_mises"] = element["von_mises"]
        for node, vector in (increment.get("supports") or {}).items():
            row.update(zip((f"{node}.reaction.{axis}" for axis in with_rotation), vector))
        row.update(zip((f"applied_force_{axis}" for axis in axes), increment.get("applied_forces") or []))
        energy = increment["energy"]
        row.update(external_work=energy["external_work"], strain_energy=energy["strain"], dissipated=energy["dissipated"])
        row["released"] = energy.get("released", 0.0)
        row.update(increment.get("diagnostics") or {})
        row["better_direction"] = point.get("better_direction", False)
        row["unexplored_modes"] = point.get("unexplored_modes", 0)
        row["degenerate"] = point.get("degenerate", False)
        row.update((f"measure.{name}", value) for name, value in (increment.get("measure") or {}).items())
        for name, value in (increment.get("stability") or {}).items():
            row[f"stability.{name}"] = value
        return row

    def column(self, name: str) -> List[Any]:
        """A quantity along the path, such as `load_factor`, `tip.y` or `tip/floor.gap`; `None` where an increment does
        not have it."""
        rows = [self.row(increment) for increment in self.increments]
        if not any(name in row for row in rows):
            raise KeyError(self.unknown(name, rows))
        return [row.get(name) for row in rows]

    def unknown(self, name: str, rows: Sequence[Mapping[str, Any]]) -> str:
        if not rows:
            return "the path has no increments"
        known = list(dict.fromkeys(known for row in rows for known in row))
        text = f"no increment has {name!r}"
        near = difflib.get_close_matches(str(name), known, 3, 0.5)
        text += f"; did you mean {' or '.join(map(repr, near))}?" if near else f"; known are {', '.join(known[:12])}, ..."
        for what, member in (("elements/", "elements"), (".reaction.", "supports")):
            if what in str(name):
                text += f' In large models {member} are recorded where they are asked for: record={{"{member}": "all"}}.'
        return text

    @property
    def dimension(self) -> int:
        return int(self.request["model"]["dimension"])

    def to_frame(self) -> Any:
        """The path as a table of pandas, with a row for each increment and the columns of the CSV table. Where the model
        names its units, `frame.attrs["units"]` has the label of each column that has one."""
        import pandas

        frame = pandas.DataFrame([self.row(increment) for increment in self.increments])
        units = self.request["model"].get("units") or {}
        labels = {name: unit_of(str(name), units.get("length"), units.get("force")) for name in frame.columns}
        frame.attrs["units"] = {name: label for name, label in labels.items() if label}
        return frame

    # Files ------------------------------------------------------------------------------------------------------------

    def save(self, file: Any, *, program: Optional[str] = None) -> None:
        """Writes the path, in the format that the extension names: `.ndjson` has the increments, one JSON object a line;
        `.csv`, `.parquet`, `.pvd` (ParaView) and the pictures `.svg` and `.png` are written by the program."""
        extension = pathlib.Path(file).suffix.lower()
        if extension in EXPORTED:
            from arcslip.program import export

            return export(self, file, program)
        if extension not in LINES:
            known = ", ".join([*LINES[1:], *EXPORTED])
            raise ValueError(f"the extension {extension!r} names no format of a path; these do: {known}")
        with open(file, "w", encoding="utf-8") as lines:
            lines.writelines(json.dumps(increment, separators=(",", ":")) + "\n" for increment in self.increments)

    @classmethod
    def load(cls, file: Any, request: Union[Model, Mapping[str, Any]]) -> "Path":
        """Reads what `save` or the program wrote, with the request or the model of the path. A last line that was cut
        off, by an interrupt, is left out. The lines do not say why the path ended: `stop_reason` is `None`."""
        with open(file, encoding="utf-8") as lines:
            text = lines.read()
        whole = text[: text.rfind("\n") + 1]
        return cls(as_request(request, {}), [json.loads(line) for line in whole.splitlines()])

    # Pictures ---------------------------------------------------------------------------------------------------------

    def of_stage(self, stage: str) -> "Path":
        """The part of the path in one stage."""
        own = [increment for increment in self.increments if increment["stage"] == stage]
        if not own:
            raise KeyError(f"the path has no stage {stage!r}; it has {sorted({row['stage'] for row in self.increments})}")
        return Path(self.request, own, self.report, self.stop_reason)

    def plot(
        self, x: Optional[str] = None, y: str = "load_factor", ax: Any = None, stage: Optional[str] = None, **style: Any
    ) -> Any:
        """Draws one quantity against another (matplotlib), along the path or along one stage; returns the axes.

        `x` is the displacement that grows most unless given. Events are marked by their kind, and descending stretches
        whose points are bifurcations are dashed.
        """
        from arcslip.picture import draw

        return draw(self if stage is None else self.of_stage(stage), x, y, ax, style)

    def largest_displacement(self) -> str:
        """The name of the displacement component that grows largest."""
        largest: Dict[str, float] = {}
        for increment in self.increments:
            for node, vector in increment["displacements"].items():
                for axis, value in zip(AXES[: self.dimension], vector):
                    name = f"{node}.{axis}"
                    largest[name] = max(largest.get(name, 0.0), abs(value))
        if not largest:
            raise ValueError("no displacement is recorded")
        return max(largest, key=lambda name: largest[name])

    def to_meshio(self, place: int = -1) -> Any:
        """The structure at an increment, by its place in the path, as a mesh of meshio: points where the nodes were, with
        displacements, reactions of supports, and status, gap, reaction and slip of contacts; as data of cells the axial
        forces of bars, of beams the mean of their ends and what the two ends have, and von Mises' stresses of solids. The
        names are those of the files for ParaView."""
        import meshio

        if not self.increments:
            raise ValueError("the path has no increments")
        increment, model = self.increments[place], self.request["model"]
        if "mesh" in model:
            raise ValueError("the nodes of the request are those of a mesh file; `arcslip solve --out path.pvd` writes them")
        nodes = list(model["nodes"])

        def in_space(vector: Sequence[float]) -> List[float]:
            own = vector[: self.dimension]
            return [float(value) for value in own] + [0.0] * (3 - len(own))

        points = [in_space(model["nodes"][node]) for node in nodes]
        nothing = [float("nan")] * 3
        displacement = [
            in_space(increment["displacements"][node]) if node in increment["displacements"] else nothing for node in nodes
        ]
        numbers = {node: number for number, node in enumerate(nodes)}
        states = {state["element"]: state for state in increment.get("elements") or []}
        cells: Dict[str, List[List[int]]] = {}
        forces: Dict[str, List[Dict[str, Any]]] = {}
        for place_of_element, element in enumerate(model["elements"]):
            joined = [numbers[node] for node in element["nodes"]]
            kind = CELLS.get(element["kind"])
            if kind is None:
                kind = {1: "vertex", 2: "line", 3: "line3"}[len(joined)]
                if kind == "line3":
                    # The node in the middle comes last.
                    joined = [joined[0], joined[2], joined[1]]
            cells.setdefault(kind, []).append(joined)
            forces.setdefault(kind, []).append(forces_of(states.get(place_of_element, {})))
        # Each name with a value that says its shape.
        names: Dict[str, Any] = {"axial_force": NAN}
        for own in (own for of_kind in forces.values() for own in of_kind):
            names.update(own)
        import numpy

        supports = increment.get("supports") or {}
        reactions = [in_space(supports[node]) if node in supports else nothing for node in nodes]
        point_data = {"displacement": displacement, **({"support_reaction": reactions} if supports else {})}
        if model.get("contacts"):
            point_data.update(at_contacts(increment, numbers, in_space))
        return meshio.Mesh(
            numpy.array(points),
            [(kind, numpy.array(joined)) for kind, joined in cells.items()],
            point_data={name: numpy.array(own) for name, own in point_data.items()},
            cell_data={
                name: [numpy.array([own.get(name, nan_like(value)) for own in of_kind]) for of_kind in forces.values()]
                for name, value in names.items()
            },
        )

    def __repr__(self) -> str:
        if not self.increments:
            return "<Path without increments>"
        last = self.increments[-1]
        end = self.stop_reason or "why it ended is not known"
        return f"<Path of {len(self)} increments to {last['load_factor']:.6g} in stage {last['stage']!r}: {end}>"


NAN = float("nan")
#: Numbers of the contacts' states, as in the files for ParaView; where a node has several, the largest.
STATES = {"free": 0, "slip": 1, "stick": 2}
NO_CONTACT = 255


def nan_like(value: Any) -> Any:
    """A number, or a list of them, that is none."""
    return [NAN] * len(value) if isinstance(value, list) else NAN


def forces_of(state: Mapping[str, Any]) -> Dict[str, Any]:
    """The forces of an element, or its stress, by the names of the files for ParaView."""
    ends = state.get("ends")
    if not ends:
        return {name: state[name] for name in ("axial_force", "von_mises") if name in state}
    found: Dict[str, Any] = {"axial_force": sum(end["axial_force"] for end in ends) / 2}
    for name, first in ends[0].items():
        last = ends[1][name]
        if isinstance(first, list):
            # In space there are two of some, about the two axes.
            one = name[: -len("s")]
            found.update((f"{one}_{axis}", [*pair]) for axis, pair in enumerate(zip(first, last), 1))
        else:
            found["beam_axial_force" if name == "axial_force" else name] = [first, last]
    return found


def at_contacts(increment: Increment, numbers: Mapping[str, int], in_space: Any) -> Dict[str, List[Any]]:
    """The contacts' state at the nodes: of several the status that holds most, the smallest gap, the sum of the reactions,
    the largest normal reaction and the largest slip in total."""
    count = len(numbers)
    status, gap, normal, slip = [NO_CONTACT] * count, [NAN] * count, [NAN] * count, [NAN] * count
    reaction = [[0.0] * 3 for _ in range(count)]
    for contact in increment["contacts"]:
        place = numbers.get(contact["node"])
        if place is None:
            continue
        own = STATES[contact["status"]]
        status[place] = own if status[place] == NO_CONTACT else max(status[place], own)
        size = sum(part * part for part in contact.get("slip_total") or []) ** 0.5
        for values, value, chosen in (
            (gap, contact["gap"], min), (normal, contact["normal_reaction"], max), (slip, size, max),
        ):
            values[place] = value if values[place] != values[place] else chosen(values[place], value)
        reaction[place] = [total + part for total, part in zip(reaction[place], in_space(contact["reaction"]))]
    return {
        "contact_status": status, "gap": gap, "contact_reaction": reaction, "normal_reaction": normal, "slip_total": slip,
    }
