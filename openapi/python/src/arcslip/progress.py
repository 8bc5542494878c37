"""A bar that grows with the increments."""

from __future__ import annotations

import warnings
from typing import Any, Dict, Iterable, Iterator, Optional


def shown(increments: Iterable[Dict[str, Any]], most: Optional[int], progress: bool) -> Iterator[Dict[str, Any]]:
    """The increments; with `progress` a bar (tqdm) shows their number, the load factor and the last event."""
    if not progress:
        yield from increments
        return
    try:
        from tqdm.auto import tqdm
    except ModuleNotFoundError:
        # The path is being traced already, and is not given up for a bar.
        warnings.warn("no progress bar is shown: it needs tqdm, `pip install tqdm`", stacklevel=2)
        yield from increments
        return

    with tqdm(total=most, unit=" increments") as bar:
        for increment in increments:
            bar.update()
            load = f"{increment['stage']} {increment['load_factor']:.6g}"
            bar.set_postfix_str(increment["point"]["event"] or load, refresh=False)
            yield increment
        # A path ends where it ends; the bound of its increments is no aim.
        bar.total = bar.n
        bar.refresh()
