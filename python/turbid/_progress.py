"""How long work tells how far it is."""

from __future__ import annotations

import sys
from typing import Callable, Optional, Union

Progress = Union[bool, Callable[[str, float], object]]
"""True for a line on stderr, or a function of the name of a stage and the part of it that is done."""


def _line(stage: str, part: float) -> None:
    text = f"turbid: {stage} {100.0 * part:3.0f} %"
    print(f"\r{text:<40}", end="\n" if part >= 1.0 else "", file=sys.stderr, flush=True)


def told(progress: Progress) -> Optional[Callable[[str, float], object]]:
    """The function to call, if there is one."""
    if callable(progress):
        return progress
    return _line if progress else None
