"""What can go wrong, each with where and what."""

from __future__ import annotations

import json
import math
import warnings
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Sequence

#: Mistakes that a message shows; the exception has all of them.
SHOWN = 20
#: Characters of a value that a message shows.
LONGEST = 120


class ArcslipError(Exception):
    """Anything that arcslip refuses or fails at."""


class ModelWarning(UserWarning):
    """Something in a model that is valid and may be a mistake, such as a coefficient of friction of 30."""


class Mistake(NamedTuple):
    """A mistake in a request: the JSON pointer (RFC 6901) of its place, what is wrong, and the value that stands there."""

    pointer: str
    detail: str
    #: `None` where nothing stands there.
    value: Any

    def __str__(self) -> str:
        text = f"{self.pointer or 'the request'}: {self.detail}"
        if self.value is None:
            return text
        value = repr(self.value)
        return f"{text}\n    here: {value if len(value) <= LONGEST else value[:LONGEST] + '...'}"


class InvalidModel(ArcslipError, ValueError):
    """A model or its analysis has mistakes, which `mistakes` lists."""

    def __init__(self, mistakes: Sequence[Mistake]):
        self.mistakes = list(mistakes)
        shown = [str(mistake) for mistake in self.mistakes[:SHOWN]]
        if len(self.mistakes) > SHOWN:
            shown.append(f"and {len(self.mistakes) - SHOWN} more")
        super().__init__("\n".join(shown))


class Refused(ArcslipError):
    """A service refuses a request; `problem` is its `application/problem+json` (RFC 9457), `status` the HTTP status."""

    def __init__(self, status: int, problem: Dict[str, Any]):
        self.status, self.problem = status, problem
        super().__init__(f"{status}: {problem.get('detail') or problem.get('title') or 'no reason is given'}")


class Unreachable(ArcslipError, OSError):
    """No service answers at the address, or not for as long as `patience` says."""


class JobFailed(ArcslipError):
    """A job, study or sweep failed; the increments so far can still be read from the job."""


class ProgramNotFound(ArcslipError):
    """The program `arcslip` is not found."""


class ProgramFailed(ArcslipError):
    """The program `arcslip` ended without a path."""


def warn(told: Iterable[str], depth: int = 3) -> None:
    """Tells what may be a mistake, as of the line that called the package; `depth` counts the calls between."""
    for text in told:
        warnings.warn(text, ModelWarning, stacklevel=depth)


def value_at(document: Any, pointer: str) -> Optional[Any]:
    """The value at a JSON pointer; `None` where there is none."""
    for step in pointer.split("/")[1:]:
        step = step.replace("~1", "/").replace("~0", "~")
        if isinstance(document, dict) and step in document:
            document = document[step]
        elif isinstance(document, list) and step.isdigit() and int(step) < len(document):
            document = document[int(step)]
        else:
            return None
    return document


def invalid(request: Any, errors: Sequence[Dict[str, Any]]) -> InvalidModel:
    """The exception of the `errors` that the program or a service lists."""
    listed = [(error.get("pointer", ""), error.get("detail", "")) for error in errors]
    # The whole request as a value would tell nothing.
    return InvalidModel([Mistake(at, detail, value_at(request, at) if at else None) for at, detail in listed])


def not_finite(document: Any, pointer: str = "") -> List[Mistake]:
    """The numbers of a document that JSON cannot hold: infinite ones, and what is no number."""
    if isinstance(document, float) and not math.isfinite(document):
        return [Mistake(pointer, "a finite number is expected", document)]
    if isinstance(document, dict):
        members = [(str(name).replace("~", "~0").replace("/", "~1"), value) for name, value in document.items()]
    elif isinstance(document, list):
        members = [(str(place), value) for place, value in enumerate(document)]
    else:
        return []
    return [mistake for step, value in members for mistake in not_finite(value, f"{pointer}/{step}")]


def text_of(request: Any) -> str:
    """The request as JSON; raises `InvalidModel` for numbers that JSON cannot hold."""
    try:
        return json.dumps(request, allow_nan=False)
    except ValueError:
        mistakes = not_finite(request)
        if not mistakes:
            raise
        raise InvalidModel(mistakes) from None
