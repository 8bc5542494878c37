"""Pictures of paths, by matplotlib."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

#: Marker and name of each kind of point.
MARKERS = {
    "smooth_limit": ("^", "smooth limit point"),
    "nonsmooth_limit": ("D", "nonsmooth limit point"),
    "contact_change": ("o", "contact change"),
    "smooth_bifurcation": ("*", "smooth bifurcation point"),
    "jump": ("s", "at rest after a jump"),
}
FALLING = "falling, bifurcation points"
#: The part of an axis from which on a stretch is seen.
SEEN = 0.005
#: Line of stretches that ascend or whose direction is the only one, and of descending stretches of bifurcation points.
LINES = {False: "-", True: "--"}


def draw(path: Any, x: Optional[str], y: str, ax: Any, style: Dict[str, Any]) -> Any:
    from matplotlib import pyplot

    x = x or path.largest_displacement()
    if ax is None:
        _, ax = pyplot.subplots()
    across, up = path.column(x), path.column(y)
    for name, values in ((x, across), (y, up)):
        if not all(value is None or isinstance(value, (int, float)) for value in values):
            raise ValueError(f"{name!r} is no number and cannot be drawn")
    color, label = style.pop("color", None), style.pop("label", None)
    stages = list(dict.fromkeys(increment["stage"] for increment in path.increments))
    # Each stage has a pattern of its own, which its load factor multiplies.
    named_by_stage = label is None and len(stages) > 1
    colors = {stage: color or next_color(ax) for stage in (stages if named_by_stage else stages[:1])}
    color = list(colors.values())[-1] if colors else color
    said = set()
    for is_dashed, first, last in stretches(path.increments):
        stage = path.increments[last - 1]["stage"]
        own = (stage if named_by_stage else label) if stage not in said else None
        said.update([stage] if named_by_stage else stages)
        ax.plot(across[first:last], up[first:last], LINES[is_dashed], color=colors.get(stage, color), label=own, **style)
    seen: Dict[str, Tuple[List[Any], List[Any]]] = {}
    for place, increment in enumerate(path.increments):
        kind = increment["point"]["kind"]
        if kind in MARKERS:
            places = seen.setdefault(kind, ([], []))
            places[0].append(across[place])
            places[1].append(up[place])
    dashed = [(first, last) for is_dashed, first, last in stretches(path.increments) if is_dashed]
    if any(is_seen(values[first:last], values) for first, last in dashed for values in (across, up)):
        # A line without points explains the dashes.
        ax.plot([], [], "--", color=color, label=None if FALLING in ax.get_legend_handles_labels()[1] else FALLING)
    named = set(ax.get_legend_handles_labels()[1])
    for kind, (horizontal, vertical) in seen.items():
        marker, name = MARKERS[kind]
        ax.plot(horizontal, vertical, marker, color=color, label=None if name in named else name)
    ax.set_xlabel(with_unit(path, x))
    ax.set_ylabel(with_unit(path, y))
    if ax.get_legend_handles_labels()[1]:
        ax.legend()
    name = path.request["model"].get("name")
    if name and not ax.get_title():
        ax.set_title(name)
    return ax


def is_seen(part: List[Any], whole: List[Any]) -> bool:
    """Whether a part of the values is long enough to be seen among all of them."""
    own, every = ([value for value in values if value is not None] for values in (part, whole))
    return bool(own) and max(own) - min(own) > SEEN * (max(every) - min(every))


def next_color(ax: Any) -> Any:
    """The color that the next line of the axes would have."""
    (line,) = ax.plot([], [])
    color = line.get_color()
    line.remove()
    return color


def stretches(increments: List[Dict[str, Any]]) -> List[Tuple[bool, int, int]]:
    """Stretches of one stage as (whether the load falls along bifurcation points, first place, place past the last);
    neighbours share a point."""
    found: List[Tuple[bool, int, int]] = []
    for place in range(1, len(increments)):
        before, here = increments[place - 1], increments[place]
        if here["stage"] != before["stage"]:
            continue
        descends = here["load_factor"] < before["load_factor"]
        is_dashed = descends and before["point"]["bifurcation"]
        if found and found[-1][0] == is_dashed and found[-1][2] == place:
            found[-1] = (is_dashed, found[-1][1], place + 1)
        else:
            found.append((is_dashed, place - 1, place + 1))
    return found


def with_unit(path: Any, name: str) -> str:
    """The name of a quantity with its unit, where the model names units."""
    units = path.request["model"].get("units") or {}
    label = unit_of(name, units.get("length"), units.get("force"))
    words = name.replace("load_factor", "load factor")
    return f"{words} [{label}]" if label else words


def unit_of(name: str, length: Optional[str], force: Optional[str]) -> Optional[str]:
    """The label of a column's unit; `None` where it has none, or the model does not name it."""
    work = f"{force} {length}" if force and length else None
    last = name.split("/")[-1]
    steps = last.split(".")
    what = steps[-1]
    if "moment" in last or name in ("external_work", "strain_energy", "dissipated", "released"):
        return work
    if ".reaction." in name and what in ("rx", "ry", "rz"):
        return work
    of_force = ("axial_force", "shear_force", "normal_reaction", "tangential_reaction", "reaction", "force")
    if any(step in of_force for step in steps) or name.startswith("applied_force"):
        return force
    if "stress" in steps or what == "von_mises":
        # The plane's stress is a force by a length and by the thickness, a length too.
        return f"{force}/{length}^2" if force and length else None
    is_displacement = what in ("x", "y", "z") and "/" not in name
    return length if is_displacement or any(step in ("gap", "slip", "slip_total") for step in steps) else None
