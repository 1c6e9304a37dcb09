"""Photon mapping in participating media, beside paths and exact solutions.

Scenes are dicts, TOML text, paths of scene files, or names of built-in scenes (:func:`builtin`). Lengths are in scene units
(L), powers in watts. What is refused raises :class:`Error`, which says in one line what is wrong and what is allowed. Work
runs beside Python: Ctrl-C ends it, and the same seed gives the same numbers on any number of threads.

* :mod:`turbid.exact`: exact values, each with a bound on its error
* :func:`measure`: the sensors of a scene, by paths, bidirectional paths, photons or light tracing, each number with its standard error
* :func:`render`: a picture with its layers and variances
* :func:`photons`: the photons themselves
* :func:`study`: what error photon maps make in a scene, and which settings reach a target the cheapest
"""

from __future__ import annotations

import inspect
import os
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _turbid, exact
from ._arguments import (
    count as _count,
    flag as _flag,
    optional_count as _optional_count,
    optional_real as _optional_real,
    real as _real,
    seed as _seed,
    threads as _threads,
)
from ._progress import Progress, told
from ._study import Study, study
from ._turbid import Error, __version__

__all__ = [
    "Error",
    "Measurement",
    "Measurements",
    "Photons",
    "Picture",
    "PHOTON",
    "PHOTON_CLASSES",
    "Study",
    "builtin",
    "exact",
    "measure",
    "photons",
    "render",
    "scene",
    "study",
]

Scene = Union[Mapping[str, Any], str, "os.PathLike[str]"]
Orders = Union[None, int, str, Sequence[Optional[int]]]


def _orders(given: Orders) -> tuple[int, Optional[int]]:
    """Orders of scattering as a pair: the least, and the most if there is one."""

    def is_order(n: Any) -> bool:
        return isinstance(n, (int, np.integer)) and not isinstance(n, bool) and bool(0 <= n < 65535)

    pair: Any = (0, None) if given is None else given
    if isinstance(given, str):
        parts = given.split("..")
        # A range may be open above; what is no number is no order.
        pair = [int(p) if p.strip().isdecimal() else None if i and not p.strip() else -1 for i, p in enumerate(parts)]
        pair = pair * 2 if len(pair) == 1 else pair
    elif not isinstance(pair, Sequence):
        pair = (pair, pair)
    is_range = len(pair) == 2 and is_order(pair[0]) and (pair[1] is None or is_order(pair[1]))
    if not is_range or (pair[1] is not None and pair[1] < pair[0]):
        raise Error(
            f"orders is {given!r}; allowed: an order such as 1, or a range such as '0..3', '1..', (0, 3) or (1, None) "
            "(both ends included), up to 65534"
        )
    return int(pair[0]), None if pair[1] is None else int(pair[1])


_PATHS, _BIDIRECTIONAL = ("paths", "path"), "bidirectional"
_METHODS = {
    "measure": dict.fromkeys(("samples",), (*_PATHS, _BIDIRECTIONAL))
    | dict.fromkeys(("photons",), ("photons", "light"))
    | dict.fromkeys(
        "maps passes k radius max_radius ray_radius ray_k beam_radius beam_fluence beam_blur beam_length ray_ends planes progressive kernel boundary".split(), ("photons",)
    )
    | {"guide": _PATHS},
    "render": dict.fromkeys(
        "global_ caustic volume importance k caustic_k volume_k radius max_radius ray_radius ray_k beam_radius beam_blur beam_length ray_ends planes kernel caustic_kernel "
        "gather_rays near step step_rule adapt spacing jitter boundary edges".split(),
        ("photons",),
    )
    | {"guide": _PATHS},
}
"""Arguments that are for some methods alone."""

_WORDS = set("with_ kernel caustic_kernel beam_blur beam_length ray_ends step_rule boundary edges".split())
"""Arguments that are words."""


def _refuse_idle(function: Any, given: Mapping[str, Any]) -> None:
    """Refuses what is no word where one is asked for, and an argument that is not its default, and that the method ignores."""
    defaults = inspect.signature(function).parameters
    for name in sorted(_WORDS & defaults.keys()):
        if given[name] is not defaults[name].default and not isinstance(given[name], str):
            raise Error(f"{name} is {given[name]!r}; allowed: text")
    with_ = given["with_"]
    known = {"photons", "light", *_PATHS, _BIDIRECTIONAL}
    for name, methods in _METHODS[function.__name__].items():
        value, default = given[name], defaults[name].default
        is_given = value is not default and not (isinstance(value, (int, float, str)) and value == default)
        if is_given and with_ in known and with_ not in methods:
            raise Error(f"{name} says nothing to with_ = {with_!r}; allowed: with {' or '.join(methods)}")


def _folder(folder: Optional[Union[str, "os.PathLike[str]"]]) -> Optional[str]:
    return None if folder is None else os.fspath(folder)


def _scene(value: Scene) -> Any:
    return dict(value) if isinstance(value, Mapping) and not isinstance(value, dict) else value


class Measurement(NamedTuple):
    """What one sensor measured: numbers, or arrays of its bins."""

    sensor: str
    """Name of the sensor."""
    quantity: str
    """Name of the quantity."""
    unit: str
    """Unit of mean and standard error."""
    mean: Any
    """Estimate: a float, or an array of the sensor's bins (i, j, k as in the scene); a last axis of 3 where colours differ."""
    std_error: Any
    """Standard error of the mean; NaN where none can be trusted."""
    n: int
    """Independent histories or maps behind it."""
    why: Any
    """Why there is no standard error: one-map, nothing-found, too-few, heavy-tail; empty where there is one."""
    middle: Optional[np.ndarray]
    """Middles of the bins [L], a last axis of 3; None without bins."""


class Measurements(Sequence):
    """Measurements in the order of the scene's sensors, also by sensor and quantity: ``found["slab", "reflectance"]``."""

    def __init__(self, rows: Sequence[Measurement], ledger: Any, estimates: Any) -> None:
        self._rows = list(rows)
        self.ledger: Optional[dict[str, float]] = ledger
        """Parts of the emitted power that were absorbed, escaped, and were followed no further; None by paths."""
        self.estimates: Optional[dict[str, int]] = estimates
        """By photons: estimates made, those with fewer than k photons within the cap, those beyond their medium."""

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, (int, np.integer, slice)):
            return self._rows[key]
        sensor, quantity = key if isinstance(key, tuple) else (key, None)
        found = [r for r in self._rows if r.sensor == sensor and quantity in (None, r.quantity)]
        if len(found) == 1:
            return found[0]
        known = ", ".join(repr((r.sensor, r.quantity)) for r in self._rows)
        raise KeyError(f"{key!r} names {len(found)} measurements; there are: {known}")

    def __repr__(self) -> str:
        def line(row: Measurement) -> str:
            if np.ndim(row.mean) == 0:
                return f"{row.sensor}  {row.quantity}  {row.mean:.6g} ± {row.std_error:.2g} {row.unit}  (n = {row.n})"
            return f"{row.sensor}  {row.quantity}  array {np.shape(row.mean)} {row.unit}  (n = {row.n})"

        return "\n".join(map(line, self._rows))


def _measurement(raw: dict) -> Measurement:
    shape = tuple(raw["shape"]) + ((3,) if raw["channels"] == 3 else ())

    def array(data: Any) -> Any:
        numbers = np.frombuffer(data).reshape(shape)
        return numbers if shape else float(numbers)

    why = raw["why"]
    why = "" if why is None else np.array(why).reshape(shape)[()]
    middle = raw["middle"]
    if middle is not None:
        middle = np.frombuffer(middle).reshape(tuple(raw["shape"]) + (3,))
    return Measurement(
        raw["sensor"],
        raw["quantity"],
        raw["unit"],
        array(raw["mean"]),
        array(raw["std_error"]),
        raw["n"],
        str(why) if np.ndim(why) == 0 else why,
        middle,
    )


def measure(
    scene: Scene,
    with_: str = "paths",
    *,
    parameters: Optional[Mapping[str, Any]] = None,
    folder: Optional[Union[str, "os.PathLike[str]"]] = None,
    samples: float = 100_000,
    photons: float = 1_000_000,
    maps: int = 16,
    passes: int = 1,
    k: Optional[int] = None,
    radius: Optional[float] = None,
    max_radius: Optional[float] = None,
    ray_radius: Optional[float] = None,
    ray_k: Optional[int] = None,
    beam_radius: Optional[float] = None,
    beam_fluence: bool = False,
    beam_blur: str = "1d",
    beam_length: str = "sampled",
    ray_ends: str = "cut",
    planes: bool = False,
    progressive: bool = False,
    kernel: str = "uniform",
    boundary: str = "clipped",
    orders: Orders = None,
    weight_windows: bool = False,
    guide: Optional[float] = None,
    seed: int = 1,
    threads: Optional[int] = None,
    progress: Progress = False,
) -> Measurements:
    """Measures the sensors of a scene, as ``turbid measure`` does: the same seed gives the same numbers.

    Parameters
    ----------
    scene : a dict, TOML text, the path of a scene file, or the name of a built-in scene
    with_ : "paths" (unbiased), "bidirectional" (unbiased: paths connected to subpaths from the lights), "photons" (tallies and
        photon maps) or "light" (photons scored as they pass)
    parameters : parameters of a built-in scene, such as ``dict(tau=1, albedo=0.9)`` (see :func:`builtin`), or keys of another
        scene with values in their place, such as ``{"regions.0.albedo": 0.5}``
    folder : where files that the scene names are; that of the scene file, or the current one
    samples : paths a sensor, or a bin of one
    photons : photons emitted, for all maps together
    maps : independent photon maps, of an equal part of the photons each
    passes : passes for the photons of each map, one in memory at a time; needs ``radius``
    k : photons that an estimate takes, the nearest; 50
    radius : radius within which an estimate takes all photons [L], in place of ``k``
    max_radius : the farthest that the k nearest photons are sought [L]; half the cell, or a mean free path
    ray_radius : radius about a whole ray, which is then read at once, for sensors of radiance: the beam radiance estimate [L]
    ray_k : the radius of each photon about rays is the distance to its ``ray_k``-th nearest other one, at most ``ray_radius``
    beam_radius : the same from photons' flights, stored as beams; in place of ``ray_radius`` [L]
    beam_fluence : read sensors of fluence from these beams too, in place of from photons in balls
    beam_blur : dimensions that beams are blurred in: 1d, 2d, or, at places, 3d
    beam_length : sampled, or whole: to the end of each medium, with what passes
    ray_ends : cut at faces, or own: each photon or beam ends where the parallel ray leaves the medium; in one homogeneous region
    planes : read light that is scattered twice and more from planes of flights, without blur; light that is scattered once by
        ``beam_radius``, for sensors of radiance
    progressive : shrink these radii, those of the first map, from map to map, so that the mean over maps converges to the light itself
    kernel : uniform, epanechnikov, biweight, cone or gaussian, as ``turbid measure --help`` lists them
    boundary : what estimates do where a medium ends: none, clipped, reflection, local-linear
    orders : orders of scattering that count: 1, "0..3", (1, None)
    weight_windows : split paths on their way to the lights; only with paths
    guide : path guiding: send out this many photons, such as 2e5, and lead paths to where they came from, and flights through
        homogeneous media to where they are: for caustics, and light that comes by way of mirrors or is bright in few places; only with
        paths, not with weight_windows, unbiased whatever the photons say
    seed : the same seed gives the same numbers, on any number of threads
    threads : all cores if none are given
    progress : True for a line on stderr, or a function of stage and part done

    Returns
    -------
    One :class:`Measurement` a sensor, with mean and standard error. Fluence and irradiance are in W/L^2, radiance in
    W/(L^2 sr), fractions of the emitted power in 1.

    Raises
    ------
    Error
        for a scene or a setting that is not allowed
    """
    _refuse_idle(measure, locals())
    options = dict(
        samples=_count("samples", samples),
        photons=_count("photons", photons),
        maps=_count("maps", maps),
        passes=_count("passes", passes),
        k=_optional_count("k", k, 0, 10**9),
        radius=_optional_real("radius", radius),
        max_radius=_optional_real("max_radius", max_radius),
        ray_radius=_optional_real("ray_radius", ray_radius),
        ray_k=_optional_count("ray_k", ray_k, 1, 10**9),
        beam_radius=_optional_real("beam_radius", beam_radius),
        beam_fluence=_flag("beam_fluence", beam_fluence),
        beam_blur=beam_blur,
        beam_length=beam_length,
        ray_ends=ray_ends,
        planes=_flag("planes", planes),
        progressive=_flag("progressive", progressive),
        kernel=kernel,
        boundary=boundary,
        orders=_orders(orders),
        weight_windows=_flag("weight_windows", weight_windows),
        guide=_optional_count("guide", guide, 1, 10**7),
        seed=_seed(seed),
        threads=_threads(threads),
    )
    given = None if parameters is None else dict(parameters)
    raw = _turbid.measure(_scene(scene), given, _folder(folder), with_, options, told(progress))
    estimates = raw["estimates"]
    if estimates is not None:
        estimates = dict(zip(("made", "underfull", "beyond"), estimates))
    return Measurements([_measurement(row) for row in raw["sensors"]], raw["ledger"], estimates)


class Picture(NamedTuple):
    """A picture in linear light, rows from the top: arrays (height, width, 3) of radiance in W/(L^2 sr)."""

    radiance: np.ndarray
    """Mean radiance."""
    variance: Optional[np.ndarray]
    """Variance of that mean, between samples, or between maps if there are several; None of one sample."""
    layers: dict[str, np.ndarray]
    """Radiance by class of path: emission, direct, caustic, indirect, single, multiple."""
    layer_variances: dict[str, np.ndarray]
    """Variance of each layer's mean; layers share their paths, so that these do not add up."""
    photons: np.ndarray
    """Photons that a sample's estimates took, (height, width)."""

    def __repr__(self) -> str:
        height, width, _ = self.radiance.shape
        mean = ", ".join(f"{channel:.6g}" for channel in self.radiance.mean((0, 1)))
        return f"picture of {width} x {height} pixels, mean radiance [{mean}], layers {', '.join(self.layers)}"


def _amount(name: str, value: Any) -> str:
    return value if isinstance(value, str) else str(_count(name, value, 1, 10**9))


def render(
    scene: Scene,
    with_: str = "photons",
    *,
    parameters: Optional[Mapping[str, Any]] = None,
    folder: Optional[Union[str, "os.PathLike[str]"]] = None,
    width: Optional[int] = None,
    height: Optional[int] = None,
    samples: float = 16,
    maps: int = 1,
    guide: Optional[float] = None,
    global_: Union[float, str] = 200_000,
    caustic: Union[float, str] = 50_000,
    volume: Union[float, str] = 65_000,
    importance: bool = False,
    k: Optional[int] = None,
    caustic_k: Optional[int] = None,
    volume_k: Optional[int] = None,
    radius: Optional[float] = None,
    max_radius: Optional[float] = None,
    ray_radius: Optional[float] = None,
    ray_k: Optional[int] = None,
    beam_radius: Optional[float] = None,
    beam_blur: str = "1d",
    beam_length: str = "sampled",
    ray_ends: str = "cut",
    planes: bool = False,
    kernel: str = "uniform",
    caustic_kernel: str = "cone",
    gather_rays: int = 64,
    near: float = 0.0,
    step: Optional[float] = None,
    step_rule: str = "integrated",
    adapt: Optional[float] = None,
    spacing: Optional[float] = None,
    jitter: bool = True,
    boundary: str = "clipped",
    edges: str = "clipped",
    seed: int = 1,
    threads: Optional[int] = None,
    progress: Progress = False,
) -> Picture:
    """Draws what a scene's camera sees, as ``turbid render`` does: the same seed gives the same numbers.

    Parameters
    ----------
    scene : a dict, TOML text, the path of a scene file, or the name of a built-in scene
    with_ : "photons" (photon maps), "paths" (unbiased), "bidirectional" (unbiased: paths connected to photons, and photons to the
        camera) or "light" (unbiased, without what is seen in mirrors and glass)
    parameters, folder, seed, threads, progress : as in :func:`measure`
    width, height : pixels; the other follows if one is given
    samples : samples a pixel of each repetition; by light tracing histories a pixel
    maps : independent repetitions, with maps of their own if by photons; the picture is their mean
    guide : as in :func:`measure`
    global_, caustic, volume : photons of the maps: a number to store, or "emit:1e6" to send out
    importance : let importance lead photons to where the camera reads them
    k, caustic_k, volume_k : photons that an estimate takes; what balances noise and blur, 100 to 1000
    radius : radius within which an estimate takes all photons [L], in place of ``k``
    max_radius : the farthest that photons are sought [L]; a tenth of the scene
    ray_radius : radius about a whole ray through media, which is then read at once, in place of a march: the beam radiance estimate [L]
    ray_k : the radius of each photon about rays is the distance to its ``ray_k``-th nearest other one, at most ``ray_radius``
    beam_radius : the same from photons' flights, stored as beams, which ``volume`` then counts; in place of ``ray_radius`` [L]
    beam_blur : dimensions that beams are blurred in: 1d or 2d
    beam_length : sampled, or whole: to the end of each medium, with what passes
    ray_ends : as in :func:`measure`
    planes : read light that media scatter twice and more from planes of flights, without blur; beside bodies ``beam_radius`` is needed
        too, for light that comes from them; in homogeneous media whose extinction is the same in all channels, without glass
    gather_rays : rays of a final gathering; 0 reads the global map where the eye looks: fast, and blotchy
    near : rays of a final gathering shorter than this are traced on [L]
    step, step_rule, adapt, jitter : the march through media; the longest step is in [L]
    spacing : steps within this many radii of a gather share one; 0 for one a step
    boundary, edges : what estimates do where media and surfaces end
    """
    _refuse_idle(render, locals())
    readout = dict(
        global_=_amount("global_", global_),
        caustic=_amount("caustic", caustic),
        volume=_amount("volume", volume),
        k=_optional_count("k", k, 1, 10**9),
        caustic_k=_optional_count("caustic_k", caustic_k, 1, 10**9),
        volume_k=_optional_count("volume_k", volume_k, 1, 10**9),
        radius=_optional_real("radius", radius),
        max_radius=_optional_real("max_radius", max_radius),
        ray_radius=_optional_real("ray_radius", ray_radius),
        ray_k=_optional_count("ray_k", ray_k, 1, 10**9),
        beam_radius=_optional_real("beam_radius", beam_radius),
        beam_blur=beam_blur,
        beam_length=beam_length,
        ray_ends=ray_ends,
        planes=_flag("planes", planes),
        kernel=kernel,
        caustic_kernel=caustic_kernel,
        gather_rays=_count("gather_rays", gather_rays, 0, 1_000_000),
        near=_real("near", near),
        step=_optional_real("step", step),
        step_rule=step_rule,
        adapt=_optional_real("adapt", adapt),
        spacing=_optional_real("spacing", spacing),
        jitter=_flag("jitter", jitter),
        boundary=boundary,
        edges=edges,
        importance=_flag("importance", importance),
    )
    raw = _turbid.render(
        _scene(scene),
        None if parameters is None else dict(parameters),
        _folder(folder),
        with_,
        _optional_count("width", width, 1, 16_384),
        _optional_count("height", height, 1, 16_384),
        _count("samples", samples),
        _count("maps", maps),
        _seed(seed),
        _optional_count("guide", guide, 1, 10**7),
        _threads(threads),
        readout,
        told(progress),
    )
    shape = (raw["height"], raw["width"])

    def image(data: Any) -> np.ndarray:
        return np.frombuffer(data).reshape(shape + (3,))

    return Picture(
        image(raw["radiance"]),
        None if raw["variance"] is None else image(raw["variance"]),
        {name: image(data) for name, data in raw["layers"].items()},
        {name: image(data) for name, data in raw["layer_variances"].items()},
        np.frombuffer(raw["photons"]).reshape(shape),
    )


PHOTON = np.dtype(
    [
        ("position", "f8", 3),
        ("direction", "f4", 3),
        ("normal", "f4", 3),
        ("power", "f4", 3),
        ("order", "u2"),
        ("flags", "u1"),
        ("class", "u1"),
    ]
)
"""A photon where it arrived: position [L], direction of travel, normal of the surface (0 in a medium), power [W] as though
its history were the only one (divide by the number emitted), scatterings so far, what it met (1 specular surfaces, 2 other
surfaces, 4 media), and the class of the light that it makes there, a number of :data:`PHOTON_CLASSES`."""

PHOTON_CLASSES = ("emission", "direct", "caustic", "indirect", "single", "multiple")
"""Names of the classes of light, as the layers of a :class:`Picture`."""


class Photons(NamedTuple):
    """Photons, and how many were sent out: estimates divide by the latter."""

    photons: np.ndarray
    """A structured array of :data:`PHOTON`: those in media, then those on surfaces, in the order of their histories."""
    emitted: int
    """Histories."""


def photons(
    scene: Scene,
    emitted: float = 100_000,
    *,
    parameters: Optional[Mapping[str, Any]] = None,
    folder: Optional[Union[str, "os.PathLike[str]"]] = None,
    at: str = "both",
    orders: Orders = None,
    seed: int = 1,
    threads: Optional[int] = None,
    progress: Progress = False,
) -> Photons:
    """Sends photons out and keeps them where they collide in media and where they meet diffuse surfaces.

    Every photon is kept with the power it arrives with, before the albedo decides what becomes of it.

    Parameters
    ----------
    scene, parameters, folder, seed, threads, progress : as in :func:`measure`
    emitted : histories
    at : where photons are kept: "media", "surfaces" or "both"
    orders : orders of scattering before the arrival: 0 is direct light
    """
    count = _count("emitted", emitted)
    raw = _turbid.photons(
        _scene(scene),
        None if parameters is None else dict(parameters),
        _folder(folder),
        count,
        at,
        _orders(orders),
        _seed(seed),
        _threads(threads),
        told(progress),
    )
    return Photons(np.frombuffer(raw, PHOTON), count)


def scene(
    name: Scene, *, folder: Optional[Union[str, "os.PathLike[str]"]] = None, **parameters: Any
) -> dict[str, Any]:
    """A scene as a dict, valid and complete, to be changed and measured: of a name with parameters, a file, TOML text.

    >>> fog = turbid.scene("slab", tau=1, albedo=0.9)
    >>> fog["regions"][0]["g"] = 0.5
    >>> turbid.measure(fog)
    """
    return _turbid.resolve(_scene(name), parameters, _folder(folder))


def builtin() -> dict[str, str]:
    """The built-in scenes by name: what each is, and its parameters with defaults and meanings, as TOML."""
    return {name: f"# {about}\n{defaults}" for name, about, defaults in _turbid.builtin()}
