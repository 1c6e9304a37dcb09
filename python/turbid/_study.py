"""Studies: what a photon map costs in accuracy in a scene of the user's."""

from __future__ import annotations

import csv
import os
import pathlib
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _turbid
from ._arguments import flag, real, seed as _seed, threads as _threads
from ._progress import Progress, told
from ._turbid import Error

_Path = Union[str, "os.PathLike[str]"]

# Columns of words, whatever the words are.
_WORDS = {"place", "unit", "reference_by", "kernel", "treatment", "rejection", "method"}


def _column(name: str, cells: Sequence[str]) -> np.ndarray:
    if name not in _WORDS:
        try:
            return np.array([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            pass
    return np.array(cells, str)


def _table(path: pathlib.Path) -> np.ndarray:
    """A table as a structured array: numbers are doubles, NaN where there is none."""
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns = [_column(name, cells) for name, cells in zip(header, zip(*rows) if rows else [()] * len(header))]
    table = np.empty(len(rows), [(name, column.dtype) for name, column in zip(header, columns)])
    for name, column in zip(header, columns):
        table[name] = column
    return table


class _Held:
    """A folder that is removed with this object: copies of what was found share it."""

    def __init__(self, folder: str) -> None:
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)

    def __deepcopy__(self, memo: dict[int, Any]) -> "_Held":
        return self


class Study:
    """What a study found."""

    out: Optional[pathlib.Path]
    """Folder of report, tables, figures and cells; None of a dry run. A temporary one is removed with this object and its copies."""
    report: Optional[pathlib.Path]
    """The report; None of a part or a dry run, which conclude nothing."""
    results: Optional[np.ndarray]
    """results.csv as a structured array: a row an estimator, number of photons and place. Numbers are float64, NaN where there
    is none, words are text. None without a report."""
    costs: Optional[np.ndarray]
    """costs.csv in the same form: CPU seconds and memory, of this machine."""
    summary: list[str]
    """The answer in sentences; of a dry run the lines of its table."""
    measured: int
    """Cells that were measured, and not there already."""

    def __init__(
        self, out: Optional[pathlib.Path], report: Optional[_Path], summary: list[str], measured: int
    ) -> None:
        self.out, self.summary, self.measured = out, summary, measured
        self._held: Optional[_Held] = None
        self.report = None if report is None else pathlib.Path(report)
        is_whole = out is not None and report is not None
        self.results = _table(out / "results.csv") if is_whole else None
        self.costs = _table(out / "costs.csv") if is_whole else None

    def __repr__(self) -> str:
        return "\n".join([f"study in {self.out}" if self.out else "study, dry run", *(f"  {s}" for s in self.summary)])


def _part(part: Any) -> Optional[str]:
    return part if part is None or isinstance(part, str) else "/".join(map(str, part))


def study(
    study: Union[Mapping[str, Any], _Path],
    *,
    out: Optional[_Path] = None,
    seed: int = 100,
    photons: float = 1.0,
    threads: Optional[int] = None,
    part: Union[None, str, tuple[int, int]] = None,
    merge: Union[_Path, Sequence[_Path]] = (),
    dry_run: bool = False,
    progress: Progress = False,
) -> Study:
    """Asks what error photon maps make in a scene, by how many photons and by which estimator, and what reaches a target the cheapest.

    As the program ``study STUDY.toml`` does, with the same tables bit by bit; ``experiments/studies/README.md`` says what a study
    holds. Ctrl-C ends it: cells in work are finished in the background, during which the folder is held, and the same call goes
    on from there.

    Parameters
    ----------
    study : the path of a study file, TOML text, or a dict, whose ``scene`` may be a file, a built-in scene, or a scene as a dict
        Files that a text or a dict names are relative to the current folder; it is kept as ``study.toml`` in ``out``.
    out : folder of what is found, in which finished cells are found again; without it a temporary one, removed with the object
        that is returned
    seed : the same seed gives the same numbers, on any number of threads
    photons : factor on every number of photons, 1e-6 to 1e6
    threads : all cores if none are given
    part : measure one part of the cells, "3/16" or (3, 16), into ``out``, and conclude nothing; parts may share a folder
    merge : conclude from the cells of these folders of parts, and measure nothing; one of them alone is ``out`` as well
    dry_run : say how many cells there are, and about how much time and memory they take, and measure nothing
    progress : True for a line on stderr, or a function of stage and part done

    Raises
    ------
    Error
        for a study, a scene or a setting that is not allowed, and parts of other studies or builds

    Examples
    --------
    >>> found = turbid.study(dict(scene="slab", photons=[1e3, 1e4], estimators=[dict(k=[25, 50, 100])]))
    >>> whole = found.results[found.results["place"] == "all"]
    >>> whole["k"], whole["rmse"], whole["rmse_error"]
    """
    dry_run = flag("dry_run", dry_run)
    if out is not None and not os.fspath(out):
        raise Error("out is empty; allowed: a folder, or None for a temporary one")
    folders = [os.fspath(merge)] if isinstance(merge, (str, os.PathLike)) else [os.fspath(one) for one in merge]
    if part is not None and (folders or dry_run):
        raise Error("part measures, merge concludes and dry_run does neither; allowed: one of them")
    if folders and dry_run:
        raise Error("merge concludes and dry_run does not; allowed: one of them")
    if part is not None and out is None:
        raise Error("a part without out would be lost; allowed: out, the folder of its cells")
    scale = real("photons", photons)
    if not 1e-6 <= scale <= 1e6:
        raise Error(f"photons is {photons!r}; allowed: a factor from 1e-6 to 1e6")
    options = dict(
        seed=_seed(seed),
        photons=scale,
        threads=_threads(threads),
        part=_part(part),
        merge=folders,
        dry_run=dry_run,
        program=_turbid.__file__,
    )
    given = dict(study) if isinstance(study, Mapping) and not isinstance(study, dict) else study
    if dry_run:
        return Study(None, *_turbid.study(given, dict(options, out=""), told(progress)))
    if out is None and len(folders) == 1:
        out = folders[0]
    if out is not None:
        found = _turbid.study(given, dict(options, out=os.fspath(out)), told(progress))
        return Study(pathlib.Path(out), *found)
    temporary = tempfile.mkdtemp(prefix="turbid-study-")
    try:
        found = Study(pathlib.Path(temporary), *_turbid.study(given, dict(options, out=temporary), told(progress)))
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise
    found._held = _Held(temporary)
    return found
