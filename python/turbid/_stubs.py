"""Type stubs of :mod:`turbid.exact`, made from its functions: ``python -m turbid._stubs > turbid/exact.pyi``."""

from __future__ import annotations

import inspect
import textwrap

from . import exact

_HEAD = '''"""Exact values of light transport, each with an absolute bound on its error. Made by `python -m turbid._stubs`."""

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from ._progress import Progress

__all__: list[str]
_PROBLEMS: dict[str, dict[str, Any]]

_Words = Union[ArrayLike, os.PathLike[str]]
_Descriptions = Union[ArrayLike, Mapping[str, Any], Sequence[Any]]

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

class Answer(Mapping[str, Value]):
    """The quantities of an answer, as attributes and by name."""

    def __init__(self, problem: str, values: dict[str, Value]) -> None: ...
    def __getitem__(self, quantity: str) -> Value: ...
    def __getattr__(self, quantity: str) -> Value: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...

def ask(problem: str, /, *, progress: Progress = False, **arguments: Any) -> Answer: ...
'''

_TYPES = {
    "nothing": "bool",
    "one": "_Words",
    "vector": "ArrayLike",
    "list": "ArrayLike",
    "descriptions": "_Descriptions",
}


def stubs() -> str:
    """The text of the file."""
    text = _HEAD
    for name, problem in exact._PROBLEMS.items():
        function = getattr(exact, name)
        takes = {argument["name"]: _TYPES[argument["takes"]] for argument in problem["arguments"]}
        words = []
        is_named = False
        for parameter in inspect.signature(function).parameters.values():
            kind = takes[parameter.name]
            if parameter.kind is parameter.KEYWORD_ONLY and not is_named:
                words.append("*")
                is_named = True
            if parameter.default is parameter.empty:
                words.append(f"{parameter.name}: {kind}")
            elif parameter.default is None:
                words.append(f"{parameter.name}: Optional[{kind}] = None")
            else:
                words.append(f"{parameter.name}: {kind} = {parameter.default!r}")
        text += f"\ndef {name}(\n" + "".join(f"    {word},\n" for word in words) + ") -> Answer:\n"
        documentation = textwrap.indent(function.__doc__.replace("\\", "\\\\"), "    ").lstrip()
        text += f'    """{documentation}    """\n'
    return text


if __name__ == "__main__":
    print(stubs(), end="")
