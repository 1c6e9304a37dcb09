"""The compiled module; see `turbid` and `turbid.exact`."""

from typing import Any, Callable, Optional

__version__: str
__file__: str

class Error(ValueError):
    """A request that was refused: what is wrong, and what is allowed."""

_Progress = Optional[Callable[[str, float], object]]
_Orders = tuple[int, Optional[int]]

def problems() -> list[dict[str, Any]]: ...
def ask(
    problem: str, questions: list[list[tuple[str, Optional[str]]]], progress: _Progress = None
) -> list[list[tuple[str, list[tuple[str, Any]], float, float, str, str]]]: ...
def resolve(scene: Any, parameters: Optional[dict[str, Any]] = None, folder: Optional[str] = None) -> dict[str, Any]: ...
def builtin() -> list[tuple[str, str, str]]: ...
def measure(
    scene: Any,
    parameters: Optional[dict[str, Any]],
    folder: Optional[str],
    with_: str,
    options: dict[str, Any],
    progress: _Progress,
) -> dict[str, Any]: ...
def render(
    scene: Any,
    parameters: Optional[dict[str, Any]],
    folder: Optional[str],
    with_: str,
    width: Optional[int],
    height: Optional[int],
    samples: int,
    maps: int,
    seed: int,
    guide: Optional[int],
    threads: Optional[int],
    readout: dict[str, Any],
    progress: _Progress,
) -> dict[str, Any]: ...
def photons(
    scene: Any,
    parameters: Optional[dict[str, Any]],
    folder: Optional[str],
    emitted: int,
    at: str,
    orders: _Orders,
    seed: int,
    threads: Optional[int],
    progress: _Progress,
) -> bytearray: ...
def study(study: Any, options: dict[str, Any], progress: _Progress) -> tuple[Optional[str], list[str], int]: ...
