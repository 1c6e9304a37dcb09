"""Exact values of light transport, each with an absolute bound on its error.

There is a function for each problem of the program ``exact``, with the arguments of its options; ``help(turbid.exact.slab)``
states equation, units, ranges and sources.

>>> slab = turbid.exact.slab(tau=1, albedo=[0.5, 0.9], g=0.75)
>>> slab.reflectance.value, slab.reflectance.bound
>>> turbid.exact.slab(1, 0.9, depth=numpy.linspace(0, 1, 50)).fluence.value

Numbers, words and arrays of either broadcast against each other. A quantity of the whole body has the shape of the arguments
that describe the body; one of places, directions or orders that of all arguments. Where one question has several values of a
quantity (layers, modes, methods), they stand along a last axis. Where there is no value, value and bound are NaN.
"""

from __future__ import annotations

import inspect
import os
import re
import textwrap
from collections.abc import Mapping
from typing import Any, Callable, Iterator, NamedTuple, Optional

import numpy as np

from . import _turbid
from ._arguments import flag
from ._progress import Progress, told
from ._turbid import Error

_PROBLEMS: dict[str, dict] = {problem["name"]: problem for problem in _turbid.problems()}

__all__ = ["Answer", "Value", "ask", *_PROBLEMS]


class Value(NamedTuple):
    """A quantity: its values, how well they are known, and where they are."""

    value: Any
    """A number, or an array."""
    bound: Any
    """Bound on the absolute error of each value."""
    unit: str
    """What the values are multiples of: 1 a pure number, mfp a mean free path."""
    at: dict[str, np.ndarray]
    """Coordinates of each value by name: numbers, or words."""
    method: str
    """How it is known."""


class Answer(Mapping):
    """The quantities of an answer, as attributes and by name."""

    def __init__(self, problem: str, values: dict[str, Value]) -> None:
        self._problem, self._values = problem, values

    def __getitem__(self, quantity: str) -> Value:
        return self._values[quantity]

    def __getattr__(self, quantity: str) -> Value:
        if quantity.startswith("_"):
            raise AttributeError(quantity)
        try:
            return self._values[quantity]
        except KeyError:
            known = ", ".join(self._values)
            raise AttributeError(f"the answer has no {quantity}; it has: {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __repr__(self) -> str:
        def line(name: str, v: Value) -> str:
            if np.ndim(v.value) == 0:
                return f"  {name}  {v.value!s} ± {v.bound:.0e}  [{v.unit}]"
            return f"  {name}  array {np.shape(v.value)}  [{v.unit}]"

        return "\n".join([self._problem, *(line(name, v) for name, v in self._values.items())])


def _text(value: Any) -> str:
    """A value as the command line has it."""
    if isinstance(value, Mapping):
        return ",".join(f"{name}={_text(part)}" for name, part in value.items())
    if isinstance(value, (list, tuple, np.ndarray)):
        return ":".join(_text(part) for part in value)
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return str(value)


def _elements(value: Any) -> np.ndarray:
    """The texts of a value, one a question."""
    if isinstance(value, (Mapping, str, os.PathLike)):
        texts = np.empty((), object)
        texts[()] = _text(value)
        return texts
    array = np.asarray(value)
    texts = np.empty(array.shape, object)
    for place in np.ndindex(array.shape):
        texts[place] = _text(array[place])
    return texts


def _vectors(value: Any) -> np.ndarray:
    """The texts of vectors, which are along the last axis; a single number is one of its own."""
    parts = _elements(value)
    if parts.ndim == 0:
        return parts
    texts = np.empty(parts.shape[:-1], object)
    for place in np.ndindex(texts.shape):
        texts[place] = ",".join(parts[place])
    return texts


def _descriptions(value: Any) -> Optional[list[str]]:
    """Texts that belong to one question; none if the value is of vectors of numbers, each of which is a question."""
    if isinstance(value, (Mapping, str)):
        return [_text(value)]
    try:
        np.asarray(value, float)
        return None
    except (TypeError, ValueError):
        return [_text(part) for part in value]


class _Questions:
    """All questions of a call."""

    def __init__(self, problem: dict, arguments: dict[str, Any]) -> None:
        self.fixed: list[tuple[str, Optional[str]]] = []
        varied: list[tuple[str, np.ndarray]] = []
        of_body: list[np.ndarray] = []
        for argument in problem["arguments"]:
            name, takes, default = argument["name"], argument["takes"], argument["default"]
            value = arguments.get(name)
            if value is None:
                if takes != "list" or len(default) < 2:
                    continue
                value = default
            if takes == "nothing":
                self.fixed += [(name, None)] if flag(name, value) else []
                continue
            if isinstance(value, np.ma.MaskedArray):
                raise Error(f"{name} is a masked array; allowed: an array of which every number counts")
            if takes == "descriptions":
                texts = _descriptions(value)
                if texts is not None:
                    self.fixed += [(name, text) for text in texts]
                    continue
            array = _vectors(value) if takes in ("vector", "descriptions") else _elements(value)
            varied.append((name, array))
            if takes in ("one", "vector"):
                of_body.append(array)
        shapes = lambda arrays: [array.shape for array in arrays]
        try:
            self.shape = np.broadcast_shapes(*shapes(array for _, array in varied))
        except ValueError:
            told = ", ".join(f"{name} {array.shape}" for name, array in varied if array.ndim)
            raise Error(f"arguments do not broadcast to one shape: {told}") from None
        self.body = np.broadcast_shapes(*shapes(of_body))
        if 0 in self.shape:
            raise Error("an argument is an empty array; allowed: at least one number")
        names = [name for name, _ in varied]
        columns = [np.broadcast_to(array, self.shape).ravel() for _, array in varied]
        rows = zip(*columns) if columns else [()]
        # Questions that are asked twice are answered once.
        numbers: dict[tuple, int] = {}
        self.number = np.array([numbers.setdefault(row, len(numbers)) for row in rows])
        self.questions = [self.fixed + list(zip(names, row)) for row in numbers]
        # Which body each question is about.
        bodies = np.arange(int(np.prod(self.body))).reshape(self.body)
        self.of_body = np.broadcast_to(bodies, self.shape).ravel()


def _collect(questions: _Questions, answers: list[list[tuple]]) -> dict[str, Value]:
    """Rows of all answers as arrays by quantity."""
    found: dict[str, list] = {}
    for place, number in enumerate(questions.number):
        seen: dict[tuple, int] = {}
        for quantity, at, value, bound, unit, method in answers[number]:
            # Several values in one question are told apart by the words of their places, then by their order.
            words = (quantity, *(word for _, word in at if isinstance(word, str)))
            seen[words] = seen.get(words, -1) + 1
            found.setdefault(quantity, []).append(
                (place, (words[1:], seen[words]), at, value, bound, unit, method)
            )
    return {quantity: _value(questions, rows) for quantity, rows in found.items()}


def _value(questions: _Questions, rows: list[tuple]) -> Value:
    keys: dict[tuple, int] = {}
    for row in rows:
        keys.setdefault(row[1], len(keys))
    is_of_body = not any(row[2] for row in rows) and len(keys) == 1
    shape = questions.body if is_of_body else questions.shape
    size, last = int(np.prod(shape)), len(keys)
    value, bound = np.full((size, last), np.nan), np.full((size, last), np.nan)
    names = list(dict.fromkeys(name for row in rows for name, _ in row[2]))
    places = {name: np.full((size, last), None, object) for name in names}
    for place, key, at, number, error, _, _ in rows:
        index = (questions.of_body[place] if is_of_body else place, keys[key])
        value[index] = number
        # The rounding of places counts in bounds: what is true of all is the largest.
        bound[index] = np.fmax(bound[index], error)
        for name, coordinate in at:
            places[name][index] = coordinate

    def shaped(array: np.ndarray) -> Any:
        return array.reshape(shape + ((last,) if last > 1 else ()))[()]

    def coordinate(array: np.ndarray) -> Any:
        is_word = any(isinstance(entry, str) for entry in array.flat)
        if is_word:
            return shaped(np.array([["" if e is None else str(e) for e in row] for row in array]))
        return shaped(np.array([[np.nan if e is None else e for e in row] for row in array], float))

    methods = "; ".join(dict.fromkeys(row[6] for row in rows))
    at = {name: coordinate(array) for name, array in places.items()}
    return Value(shaped(value), shaped(bound), rows[0][5], at, methods)


def ask(problem: str, /, *, progress: Progress = False, **arguments: Any) -> Answer:
    """Asks a problem by name; its arguments are those of the function of that name.

    ``progress`` is True for a line on stderr, or a function of a name and the part of the questions that is answered.
    """
    if problem not in _PROBLEMS:
        raise Error(f"problem is '{problem}'; allowed: {', '.join(_PROBLEMS)}")
    known = [argument["name"] for argument in _PROBLEMS[problem]["arguments"]]
    for name in arguments:
        if name not in known:
            raise Error(f"{problem} has no argument '{name}'; allowed: {', '.join(known)}")
    questions = _Questions(_PROBLEMS[problem], arguments)
    answers = _turbid.ask(problem, questions.questions, told(progress))
    return Answer(problem, _collect(questions, answers))


_TAKES = {
    "nothing": "bool",
    "one": "number, word or array",
    "vector": "numbers along the last axis, in place of one number",
    "list": "number or array",
    "descriptions": "a description or several: text, dict, or coordinates along the last axis",
}


def _default(argument: dict) -> Any:
    """What a signature shows: numbers as numbers."""

    def plain(text: str) -> Any:
        for read in (int, float):
            try:
                return read(text)
            except ValueError:
                continue
        return text

    if argument["required"]:
        return inspect.Parameter.empty
    if argument["takes"] == "nothing":
        return False
    values = tuple(plain(text) for text in argument["default"])
    return None if not values else values[0] if len(values) == 1 else values


def _signature(problem: dict) -> inspect.Signature:
    required = [a for a in problem["arguments"] if a["required"]]
    optional = [a for a in problem["arguments"] if not a["required"]]
    kind = inspect.Parameter
    parameters = [kind(a["name"], kind.POSITIONAL_OR_KEYWORD) for a in required]
    parameters += [kind(a["name"], kind.KEYWORD_ONLY, default=_default(a)) for a in optional]
    return inspect.Signature(parameters, return_annotation=Answer)


def _named(text: str) -> str:
    """Options by the names of the arguments that they are here."""
    return re.sub(r"--([a-z][a-z0-9-]*)", lambda found: f"`{found[1].replace('-', '_')}`", text)


def _documentation(problem: dict) -> str:
    lines = [_named(problem["about"].rstrip()), "", "Parameters", "----------"]
    for argument in problem["arguments"]:
        lines.append(f"{argument['name']} : {_TAKES[argument['takes']]}")
        allowed = f" Allowed: {', '.join(argument['allowed'])}." if argument["allowed"] else ""
        text = _named(" ".join(argument["help"].split()))
        text += ("" if text.endswith(".") else ".") + allowed
        lines += textwrap.wrap(text, 116, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines) + "\n"


def _function(problem: dict) -> Callable[..., Answer]:
    name, signature = problem["name"], _signature(problem)

    def function(*args: Any, **kwargs: Any) -> Answer:
        return ask(name, **signature.bind(*args, **kwargs).arguments)

    function.__name__ = function.__qualname__ = name
    function.__module__ = __name__
    function.__doc__ = _documentation(problem)
    function.__signature__ = signature  # type: ignore[attr-defined]
    return function


for _name, _problem in _PROBLEMS.items():
    globals()[_name] = _function(_problem)
del _name, _problem
