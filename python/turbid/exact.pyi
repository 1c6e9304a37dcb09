"""Exact values of light transport, each with an absolute bound on its error. Made by `python -m turbid._stubs`."""

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

def slab(
    tau: _Words,
    albedo: _Words,
    *,
    g: Optional[_Words] = None,
    g2: Optional[_Words] = None,
    share: Optional[_Words] = None,
    rayleigh: bool = False,
    moments: Optional[_Words] = None,
    table: Optional[_Words] = None,
    degree: _Words = 100,
    mu0: _Words = 1,
    index: _Words = 1,
    depth: Optional[ArrayLike] = None,
    mu: Optional[ArrayLike] = None,
    azimuth: ArrayLike = 0,
    order: Optional[ArrayLike] = None,
    method: _Words = 'auto',
) -> Answer:
    """A homogeneous slab: fluxes, fluence, radiance of scattered light, orders of scattering.

    The radiance I of scattered light obeys, with t the depth below the lit face, mu > 0 upwards and w the albedo,

      mu dI/dt = I - w int p(W.W') I(t, W') dW' - w p(W.W0) e^(-t/mu0)/mu0

    for a beam of cosine mu0 and unit irradiance on the face (`diffuse`: radiance 1/pi from all directions outside).
    Fluxes are fractions of the incident power, R + T + A = 1; T includes the direct light. The fluence includes the
    direct light, the radiance [1/sr] leaves it out; both are per unit irradiance.

    Isotropic scattering: the Peierls equation phi = phi_0 + (w/2) int E_1(|t-t'|) phi(t') dt' with a residual bound.
    Any other phase function: discrete ordinates on two sets of nodes. Thickness 1e-12 to 1e9, g -0.95 to 0.99.
    Source: Peierls 1939; Case and Zweifel 1967; Chandrasekhar 1960; Stamnes, Tsay, Wiscombe and Jayaweera 1988.

    Parameters
    ----------
    tau : number, word or array
        Optical thickness, in mean free paths, 1e-12 to 1e9.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    g : number, word or array
        Henyey-Greenstein scattering of this mean cosine: checked from -0.95 to 0.99, and answered beyond as far as its
        moments allow.
    g2 : number, word or array
        With `g` and `share`: the mean cosine of a second Henyey-Greenstein term.
    share : number, word or array
        Share of the first of two terms, 0 to 1.
    rayleigh : bool
        Rayleigh scattering without polarisation, 3 (1 + cos^2)/(16 pi).
    moments : number, word or array
        Legendre moments chi_0 = 1, chi_1, ... of p = 1/(4 pi) sum (2l+1) chi_l P_l, separated by commas, blanks or
        lines, in a file of up to 16 MiB; # begins a comment.
    table : number, word or array
        Values at cosines from -1 to 1 in rising order, in any unit, as lines `cosine,value` of a file of up to 16 MiB;
        linear in between; # begins a comment. What is used is the sum of its Legendre moments, which must not be
        negative.
    degree : number, word or array
        Highest moment of `table`, 0 to 1999; a peak needs about pi over its width.
    mu0 : number, word or array
        Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    index : number, word or array
        Refractive index inside over outside, 0.25 to 4: faces that reflect and refract (fluxes and fluence). Gives also
        the light that the first face sends back (`specular`), what leaves that was scattered (`reflectance_diffuse`),
        and the part of Lambertian light that one face reflects, from outside and from inside.
    depth : number or array
        Depths in mean free paths, 0 to tau, at which to give the fluence and the net flux downwards (direct light
        included).
    mu : number or array
        Signed cosines (positive: towards the lit face) at which to give the radiance of scattered light, at every
        depth, or without depths where the light leaves.
    azimuth : number or array
        Azimuths of those directions, in radians: that of propagation minus that of the beam.
    order : number or array
        Orders of scattering to give one by one, 0 (direct light) to 100, to 1000 with isotropic scattering up to
        thickness 400.
    method : number, word or array
        How to solve it. Allowed: auto, peierls, ordinates, doubling.
    """

def layers(
    layer: _Descriptions,
    *,
    ground: _Words = 0,
    ground_index: _Words = 1,
    exitance: _Words = 0,
    mu0: _Words = 1,
    depth: Optional[ArrayLike] = None,
    mu: Optional[ArrayLike] = None,
    method: _Words = 'adding',
) -> Answer:
    """Homogeneous layers over a ground: fluxes, absorption by layer, fluence, radiance; sources in the layers.

    The azimuthal mean I of the radiance obeys, with t the depth below the lit face, mu > 0 upwards, and w, chi_l and q the
    albedo, moments and source of the layer,

      mu dI/dt = I - (w/2) int sum_l (2l+1) chi_l P_l(mu) P_l(mu') I(t, mu') dmu' - beam - q/(4 pi)

    and is continuous where the index of refraction is. Elsewhere is a smooth face: Fresnel's laws for unpolarised light,
    powers of its reflections add. Above the layers the index is 1. The ground is Lambertian (0: black) or a mirror. Powers are
    per incident power, q is power that starts per area and mean free path over the irradiance; in the dark (`mu0` none) all
    is in the unit of the sources. T is what arrives at the ground, R + sum A + A_ground = 1 + sum q tau.

    Adding of layers that are doubled each, or discrete ordinates matched at all interfaces, on two sets of nodes. Layers
    1e-12 to 100 thick, 400 together; tau=0,albedo=0,index=1.5 is a clear plate of glass.
    Source: van de Hulst 1963; Hansen and Travis 1974; Stamnes, Tsay, Wiscombe and Jayaweera 1988; Prahl, van Gemert and
    Welch 1993.

    Parameters
    ----------
    layer : a description or several: text, dict, or coordinates along the last axis
        A layer, from the lit face down, as name=value separated by commas: tau (1e-12 to 100), albedo (0 to 1); g
        (Henyey-Greenstein, 0 if not given), phase=rayleigh or moments=FILE; emission (0 or more, in a layer of 1e-6 or
        more); index (of refraction, over that above the layers, 0.25 to 4, 1 if not given). Once for each layer, or
        with | between them.
    ground : number, word or array
        Reflectance of the ground, 0 to 1, or the word mirror, or mirror=R of reflectance R.
    ground_index : number, word or array
        Index of refraction of what lies between the last layer and the ground, 0.25 to 4; that of the layer: no gap.
    exitance : number, word or array
        Power per area that the ground sends out by itself, over the irradiance.
    mu0 : number, word or array
        Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light), or none.
    depth : number or array
        Depths in mean free paths, 0 to that of the ground, at which to give fluence and fluxes (direct light included).
    mu : number or array
        Signed cosines (positive: towards the lit face), 1e-5 or more in magnitude, at which to give the mean over
        azimuth of the radiance, without direct light, at every depth, or without depths where the light leaves.
    method : number, word or array
        How to solve it. Allowed: adding, ordinates.
    """

def half_space(
    albedo: _Words,
    *,
    g: Optional[_Words] = None,
    g2: Optional[_Words] = None,
    share: Optional[_Words] = None,
    rayleigh: bool = False,
    moments: Optional[_Words] = None,
    table: Optional[_Words] = None,
    degree: _Words = 100,
    mu0: _Words = 1,
    mu: Optional[ArrayLike] = None,
    azimuth: ArrayLike = 0,
    depth: Optional[ArrayLike] = None,
    milne: bool = False,
) -> Answer:
    """A half-space: H function, reflectance, radiance, fluence, Milne's problem.

    The medium fills t > 0, with unit irradiance on its face. With w the albedo, H Chandrasekhar's function and
    isotropic scattering,

      H(mu) = 1 + (w/2) mu H(mu) int_0^1 H(m)/(mu + m) dm
      R     = 1 - sqrt(1-w) H(mu0)                           (diffuse: averaged over 2 mu0 dmu0)
      I(mu) = (w/4 pi) H(mu) H(mu0)/(mu + mu0)               [1/sr], leaving at cosine mu

    `h_moment` is int_0^1 mu^n H dmu. The fluence includes the direct light. In Milne's problem light comes from infinitely
    deep: far from the face the fluence goes as sinh(k (t + z0)), with decay k and extrapolation length z0 in mean free
    paths; radiance and fluence are per unit power that leaves. With any other phase function by discrete ordinates.
    Source: Hopf 1934; Chandrasekhar 1960, chapter V; Stibbs and Weir 1959; Case and Zweifel 1967, chapter 6.

    Parameters
    ----------
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    g : number, word or array
        Henyey-Greenstein scattering of this mean cosine: checked from -0.95 to 0.99, and answered beyond as far as its
        moments allow.
    g2 : number, word or array
        With `g` and `share`: the mean cosine of a second Henyey-Greenstein term.
    share : number, word or array
        Share of the first of two terms, 0 to 1.
    rayleigh : bool
        Rayleigh scattering without polarisation, 3 (1 + cos^2)/(16 pi).
    moments : number, word or array
        Legendre moments chi_0 = 1, chi_1, ... of p = 1/(4 pi) sum (2l+1) chi_l P_l, separated by commas, blanks or
        lines, in a file of up to 16 MiB; # begins a comment.
    table : number, word or array
        Values at cosines from -1 to 1 in rising order, in any unit, as lines `cosine,value` of a file of up to 16 MiB;
        linear in between; # begins a comment. What is used is the sum of its Legendre moments, which must not be
        negative.
    degree : number, word or array
        Highest moment of `table`, 0 to 1999; a peak needs about pi over its width.
    mu0 : number, word or array
        Cosine of incidence of a beam, above 0 to 1, or the word diffuse (Lambertian light).
    mu : number or array
        Cosines, 0 to 1, at which to give the radiance that leaves, and H.
    azimuth : number or array
        Azimuths of those directions, in radians, where scattering is not isotropic: that of propagation minus the
        beam's.
    depth : number or array
        Depths in mean free paths, 0 or more, at which to give fluence and net flux downwards.
    milne : bool
        Answer Milne's problem at these cosines and depths, instead of the lit face (albedo 0.01 to 1).
    """

def thick(
    albedo: _Words,
    *,
    g: Optional[_Words] = None,
    g2: Optional[_Words] = None,
    share: Optional[_Words] = None,
    rayleigh: bool = False,
    moments: Optional[_Words] = None,
    table: Optional[_Words] = None,
    degree: _Words = 100,
    mu0: _Words = 1,
    tau: Optional[ArrayLike] = None,
    u: Optional[ArrayLike] = None,
) -> Answer:
    """Thick slabs by asymptotics: decays, deep pattern, escape, and R and T of any thickness above some.

    Deep inside, light decays as P(u) e^(-kt), u the cosine to the direction of decay. With K the escape function,

      T = m n K(mu0) e^(-k tau)/(1 - l^2 e^(-2k tau)),   R = R_inf - l e^(-k tau) T
      m = 2 int_-1^1 u P^2 du,  n = 2 int_0^1 u K du,  l = 2 int_0^1 u K(u) P(-u) du
      albedo 1: T = (4/3) K/((1-g)(tau + 2z)),  R = 1 - T

    z is Milne's extrapolation length; lengths in mean free paths, decays in their inverse. The bound says how much the
    faster decays, k2 and beyond, may still do: in thin slabs as much as the answer. A peak, by `g` or by moments, takes some
    seconds, however many thicknesses are asked.
    Source: van de Hulst 1980, chapter 5; Sobolev 1975, chapter 3.

    Parameters
    ----------
    albedo : number, word or array
        Single-scattering albedo, 0.1 to 1, where the slowest decay is below 0.999: from 0.263 on if scattering is
        isotropic.
    g : number, word or array
        Henyey-Greenstein scattering of this mean cosine: checked from -0.95 to 0.99, and answered beyond as far as its
        moments allow.
    g2 : number, word or array
        With `g` and `share`: the mean cosine of a second Henyey-Greenstein term.
    share : number, word or array
        Share of the first of two terms, 0 to 1.
    rayleigh : bool
        Rayleigh scattering without polarisation, 3 (1 + cos^2)/(16 pi).
    moments : number, word or array
        Legendre moments chi_0 = 1, chi_1, ... of p = 1/(4 pi) sum (2l+1) chi_l P_l, separated by commas, blanks or
        lines, in a file of up to 16 MiB; # begins a comment.
    table : number, word or array
        Values at cosines from -1 to 1 in rising order, in any unit, as lines `cosine,value` of a file of up to 16 MiB;
        linear in between; # begins a comment. What is used is the sum of its Legendre moments, which must not be
        negative.
    degree : number, word or array
        Highest moment of `table`, 0 to 1999; a peak needs about pi over its width.
    mu0 : number, word or array
        Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light).
    tau : number or array
        Optical thicknesses, 1 to 1e15: gives R, T and A.
    u : number or array
        Cosines u to the direction of decay, -1 to 1: gives the pattern P(u) of light deep inside.
    """

def two_stream(
    tau: _Words,
    albedo: _Words,
    *,
    g: _Words = 0,
    mu0: _Words = 1,
    depth: Optional[ArrayLike] = None,
) -> Answer:
    """Two streams and diffusion beside the exact slab: how wrong they are.

    The radiance is replaced by one flux up, F+, and one down, F-; with s = F+ + F-, d = F+ - F-, b = 1/mu0:

      ds/dt = c_s d - w b D e^(-bt),   dd/dt = c_d s - w b e^(-bt)

      Eddington    c_d = 2 (1-w)      c_s = (3/2)(1-wg)      D = -(3/2) g mu0     fluence 2 s
      quadrature   c_d = sqrt3 (1-w)  c_s = sqrt3 (1-wg)     D = -sqrt3 g mu0     fluence sqrt3 s
      delta-Eddington: Eddington, a share g^2 of all scattering counted as straight on
      diffusion: Eddington, with the field vanishing 0.7104/(1-wg) mean free paths outside

    tau in mean free paths. Each quantity comes exactly, then in every approximation, whose `error` is what it differs by (with
    the bound of the exact value), so that here too it covers the truth.
    Source: Eddington 1916; Joseph, Wiscombe and Weinman 1976; Meador and Weaver 1980.

    Parameters
    ----------
    tau : number, word or array
        Optical thickness, 1e-12 to 1e9 mean free paths.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    g : number, word or array
        Mean cosine of Henyey-Greenstein scattering, -0.95 to 0.99.
    mu0 : number, word or array
        Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light).
    depth : number or array
        Depths in mean free paths, 0 to tau, at which to give the fluence.
    """

def xy(
    tau: _Words,
    albedo: _Words,
    *,
    mu: ArrayLike = (0.1, 0.5, 1),
    mu0: Optional[_Words] = None,
) -> Answer:
    """Chandrasekhar's X and Y functions: all that leaves a slab of isotropic scattering, by two functions of one cosine.

    With w the albedo, tau the thickness and phi the fluence under a beam of cosine mu and unit irradiance,

      X(mu) = mu phi(0),  Y(mu) = mu phi(tau),  a_0 = int_0^1 X dmu,  b_0 = int_0^1 Y dmu
      I_up(mu) = (w/4 pi) (X X_0 - Y Y_0)/(mu + mu0),  I_down(mu) = (w/4 pi) (Y X_0 - X Y_0)/(mu - mu0)     [1/sr]
      R = 1 - X_0 (1 - w a_0/2) - Y_0 w b_0/2,         T = Y_0 (1 - w a_0/2) + X_0 w b_0/2

    tau in mean free paths; all but the radiances are pure numbers. (1 - w a_0/2)^2 - (w b_0/2)^2 = 1 - w.
    Source: Chandrasekhar 1960, chapter VIII; Mullikin 1964; Sobolev 1975; van de Hulst 1980, chapter 7.

    Parameters
    ----------
    tau : number, word or array
        Optical thickness, 1e-12 to 400 mean free paths.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    mu : number or array
        Cosines, 0 to 1.
    mu0 : number, word or array
        Cosine of incidence, above 0 to 1: gives R, T and the radiances that leave at every cosine.
    """

def sphere(
    radius: _Words,
    albedo: _Words,
    *,
    source: _Words = 'uniform',
    r: Optional[ArrayLike] = None,
    mu: Optional[ArrayLike] = None,
    order: Optional[ArrayLike] = None,
) -> Answer:
    """A sphere with isotropic scattering: fluence, escape, absorption, radiance that leaves.

    In a ball of radius a whose surface does not reflect, with w the albedo and phi_0 the light that has not collided,

      phi(r) = phi_0(r) + (w/2) int_0^a (r'/r) [E_1(|r-r'|) - E_1(r+r')] phi(r') dr'

    `escape_direct` leaves without a collision, in closed form: all the escape of a sphere that only absorbs, for a uniform
    source 3/(8 a^3) [2 a^2 - 1 + (1 + 2a) e^(-2a)].

    Lengths are mean free paths. Sources: `uniform` emission over the volume and a point at the `centre`, of unit power
    (fluence in 1/mean free path^2, radiance per steradian of that); `incident` light of radiance 1/pi and irradiance 1
    on the whole surface (fluence a pure number, radiance in 1/sr). Fluences include the direct light; so does radiance,
    but for the central source, whose direct light e^(-a)/(4 pi a^2) leaves at mu = 1 alone.
    Source: Davison 1957, chapter VI; Case and Zweifel 1967, chapters 2 and 6.

    Parameters
    ----------
    radius : number, word or array
        Radius in mean free paths.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    source : number, word or array
        Where the light comes from. Allowed: uniform, centre, incident.
    r : number or array
        Distances from the centre in mean free paths, 0 to the radius, at which to give the fluence and its direct part,
        and the probability that light emitted there leaves without a collision.
    mu : number or array
        Cosines to the outward normal, 0 to 1, at which to give the radiance that leaves.
    order : number or array
        Orders of scattering whose fluence to give at every r: 0 (direct light) to 1000, from a central source to 8;
        radius up to 64.
    """

def cuboid(
    sides: ArrayLike,
    albedo: _Words,
    *,
    source: _Words = 'face',
    at: Optional[_Descriptions] = None,
) -> Answer:
    """A cuboid, or a rectangular duct without end, of isotropic scattering: fluence, source function, absorption.

    In the body 0 <= x <= a, 0 <= y <= b, 0 <= z <= c (a duct has no c, and is the same at every z), with w the albedo and phi_0 the
    light that has not collided,

      phi(r) = phi_0(r) + w int K(|r-r'|) phi(r') dr',   K(d) = e^(-d)/(4 pi d^2),   of a duct Ki_1(d)/(2 pi d)

    Lengths are mean free paths. Sources: isotropic light of irradiance 1 (radiance 1/pi) on the `face` x = 0 or on all `faces`, a
    `beam` along x of irradiance 1 on the face x = 0 (fluence a pure number); `uniform` emission of unit power over the volume (fluence in
    1/mean free path^2; of a duct, of unit power over a mean free path of its length). `source_function` is w phi/(4 pi), with what is
    emitted. Galerkin's method in Legendre polynomials; the bound is the difference of three degrees.
    Source: Crosbie and Schrenker 1984; Altac and Spinrad 1990.

    Parameters
    ----------
    sides : numbers along the last axis, in place of one number
        Sides a, b, c of a cuboid or a, b of a duct, in mean free paths, 1e-3 to 20, none more than 20 times another.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    source : number, word or array
        Where the light comes from. Allowed: face, faces, uniform, beam.
    at : a description or several: text, dict, or coordinates along the last axis
        A place x,y,z (of a duct x,y), in mean free paths, at which to give fluence and source function. Once for each
        place.
    """

def emitting_cube(
    at: _Descriptions,
    *,
    peak: _Words = 0.9,
    base: _Words = 0.1,
) -> Answer:
    """A unit cube that absorbs and emits at one temperature between cold black walls: fluence, divergence of the flux, flux into the walls.

    With the absorption coefficient kappa = peak (1-2|x-1/2|)(1-2|y-1/2|)(1-2|z-1/2|) + base per side, sigma T^4 = 1 and tau the optical
    depth from a place to the wall,

      phi = 4 - (1/pi) int e^(-tau) dOmega,   div q = kappa (4 - phi),   q_wall = 1 - (1/pi) int e^(-tau) cos(theta) dOmega

    fluence and flux in units of sigma T^4, the divergence in that per side. `flux` is given where the place lies on a wall (of an edge, on the
    wall across the first axis).
    Source: Burns and Christon 1997.

    Parameters
    ----------
    peak : number, word or array
        Absorption in the middle above that at the walls, per side, 0 to 10.
    base : number, word or array
        Absorption at the walls, per side, 0 to 10.
    at : a description or several: text, dict, or coordinates along the last axis
        A place x,y,z in the cube, coordinates 0 to 1. Once for each place.
    """

def nested(
    source: _Words,
    at: _Descriptions,
    *,
    cuboid: Optional[_Descriptions] = None,
    mirror: Optional[_Words] = None,
) -> Answer:
    """Light of a cuboid that emits, uncollided, through cuboids of other extinctions: a shield with ducts.

      phi(r) = int q e^(-tau(r,r'))/(4 pi |r-r'|^2) dr',   q = 1 per volume in the source

    Of cuboids that overlap the later one counts; outside all of them nothing is absorbed. With `mirror`, planes x, y or z = 0 reflect, and
    cuboids, source and places lie at 0 or above there. Lengths are in any unit, extinctions per that length, the fluence is over the power per
    volume: a length. What scatters has no part in it: albedo 0, or the uncollided light of any medium.
    Source: Kobayashi, Sugimura and Nagaya 2000 (OECD/NEA), case i.

    Parameters
    ----------
    cuboid : a description or several: text, dict, or coordinates along the last axis
        A cuboid of the medium by its extents and its extinction. Once for each cuboid.
    source : number, word or array
        The cuboid that emits.
    mirror : number, word or array
        Axes whose plane 0 is a mirror, as the letters of some of x, y and z: xyz.
    at : a description or several: text, dict, or coordinates along the last axis
        A place x,y,z. Once for each place.
    """

def cavity(
    wall_albedo: _Words,
    *,
    radius: _Words = 1,
    albedo: Optional[_Words] = None,
    first: Optional[_Words] = None,
    r: Optional[ArrayLike] = None,
) -> Answer:
    """A spherical cavity with a diffusely reflecting wall, empty or filled: irradiance of the wall.

    With rho the wall's albedo, A the fraction of isotropic incident light that the medium absorbs and E_1 the irradiance
    before the wall's first reflection,

      E = E_1/(1 - rho (1-A))          empty, any source: E(x) = E_0(x) + rho mean(E_0)/(1 - rho)

    `irradiance_wall` is per unit of exitance that the wall itself emits evenly (a pure number); `irradiance_centre` per unit
    power of a point source at the centre, in 1/length^2; `irradiance_mean` of any source, in the unit of `first`. `rounds`
    = 1/(1 - rho (1-A)). Lengths are mean free paths (empty: any unit). Irradiance is counted before reflection.
    Source: Sumpner 1892; Walsh 1958, chapter 8.

    Parameters
    ----------
    radius : number, word or array
        Radius in mean free paths; empty: in any unit.
    wall_albedo : number, word or array
        Albedo of the wall, 0 to 1 (1 only if the medium absorbs).
    albedo : number, word or array
        Single-scattering albedo of the medium, 0 to 1; without it the cavity is empty.
    first : number, word or array
        Mean irradiance of the wall before its first reflection, of any source: gives the mean irradiance.
    r : number or array
        Distances from the centre, 0 to the radius, at which to give the fluence if the wall emits evenly, per unit
        exitance.
    """

def critical(
    secondaries: _Words,
    *,
    shape: _Words = 'slab',
    x: Optional[ArrayLike] = None,
) -> Answer:
    """Critical slab or sphere: the size at which a multiplying medium keeps itself going, and the shape of its light.

    Where each collision sends out c > 1 on the average, isotropically, one size has a positive solution without source:

      phi = (c/2) K phi,   K the integral of E_1(|t-t'|) (slab), of the same on odd u = r phi (sphere)

    `size` is the half-thickness or the radius in mean free paths; `flux_ratio` the fluence over that in the middle, at x, the
    distance from the middle over the size.
    Source: Davison 1957, chapter VIII; Case and Zweifel 1967, section 6.8; Kaper, Lindeman and Leaf 1974; Sood, Forster
    and Parsons 2003.

    Parameters
    ----------
    secondaries : number, word or array
        Mean number of secondaries a collision, c, 1 + 1e-12 to 1000.
    shape : number, word or array
        The body. Allowed: slab, sphere.
    x : number or array
        Distances from the middle over the size, 0 to 1, at which to give the fluence over that in the middle.
    """

def path(
    shape: _Words,
    size: ArrayLike,
    *,
    chord: Optional[ArrayLike] = None,
    albedo: Optional[_Words] = None,
) -> Answer:
    """Mean path of isotropic light in a convex body: 4 V/S, whatever the medium scatters.

    Light that falls isotropically and evenly on the whole surface S of a convex body of volume V travels

      mean path = 4 V/S

    in it before it leaves, for any phase function and any amount of scattering, if nothing is absorbed. With absorption the
    path to escape or absorption is l = A/(1-w) mean free paths, A the absorbed fraction: given for sphere and slab with
    isotropic scattering. Lengths in one unit of your choice; with `albedo` they are mean free paths.
    Source: Dirac 1943; Case and Zweifel 1967, section 2.8; Blanco and Fournier 2003; Mazzolo 2004.

    Parameters
    ----------
    shape : number, word or array
        The body. Allowed: sphere, slab, cuboid, convex.
    size : numbers along the last axis, in place of one number
        Radius of the sphere, thickness of the slab, or the three edges of the cuboid; for any convex body its volume
        and its surface. 1e-100 to 1e100.
    chord : number or array
        Lengths of chords of sphere or slab, 0 or more: gives the density of the chord length under that light.
    albedo : number, word or array
        Single-scattering albedo, 0 to 1, of sphere or slab (then up to 1e6 or 400 mean free paths).
    """

def infinite(
    albedo: _Words,
    *,
    g: Optional[_Words] = None,
    g2: Optional[_Words] = None,
    share: Optional[_Words] = None,
    rayleigh: bool = False,
    moments: Optional[_Words] = None,
    table: Optional[_Words] = None,
    degree: _Words = 100,
    r: Optional[ArrayLike] = None,
    wave: Optional[ArrayLike] = None,
    scatterings: Optional[ArrayLike] = None,
) -> Answer:
    """An isotropic point source of unit power in an unbounded medium, beside its asymptote and diffusion theory.

    With w the albedo, chi_l the Legendre moments of the phase function and h_l = (2l+1)(1 - w chi_l), the fluence obeys

      int phi(r) e^(i s.r) d^3r = 1/(h_0 + s^2/(h_1 + 4 s^2/(h_2 + 9 s^2/(h_3 + ...))))
      phi(r) = 1/(4 pi r) [sum_j N_j e^(-k_j r) + a continuum of decays of 1 and more]

    r in mean free paths, fluence and net flux outwards in 1/mean free path^2 per unit power. `asymptotic_fluence` is
    the slowest exponential alone; `diffusion_fluence` = 3 (1-wg) e^(-kr)/(4 pi r), k^2 = 3 (1-w)(1-wg), is an
    approximation, whose bound is that of the formula.
    Source: Case, de Hoffmann and Placzek 1953; Grosjean 1956; Case and Zweifel 1967, chapter 5.

    Parameters
    ----------
    albedo : number, word or array
        Single-scattering albedo, 0 to 1.
    g : number, word or array
        Henyey-Greenstein scattering of this mean cosine: checked from -0.95 to 0.99, and answered beyond as far as its
        moments allow.
    g2 : number, word or array
        With `g` and `share`: the mean cosine of a second Henyey-Greenstein term.
    share : number, word or array
        Share of the first of two terms, 0 to 1.
    rayleigh : bool
        Rayleigh scattering without polarisation, 3 (1 + cos^2)/(16 pi).
    moments : number, word or array
        Legendre moments chi_0 = 1, chi_1, ... of p = 1/(4 pi) sum (2l+1) chi_l P_l, separated by commas, blanks or
        lines, in a file of up to 16 MiB; # begins a comment.
    table : number, word or array
        Values at cosines from -1 to 1 in rising order, in any unit, as lines `cosine,value` of a file of up to 16 MiB;
        linear in between; # begins a comment. What is used is the sum of its Legendre moments, which must not be
        negative.
    degree : number, word or array
        Highest moment of `table`, 0 to 1999; a peak needs about pi over its width.
    r : number or array
        Distances in mean free paths, 1e-12 to 1e6.
    wave : number or array
        Wave numbers s in 1/mean free path, 0 to 1e5: gives the transform of the fluence, the fraction above.
    scatterings : number or array
        Numbers n of scatterings, 0 to 999999: gives the mean cosine between the first direction and that after n, g^n,
        and the mean square distance from the source after the flight that follows the n-th, absorption aside.
    """

def kernel(
    kernel: _Words,
    *,
    dimension: _Words = 3,
    gradient: Optional[ArrayLike] = None,
    depth: Optional[ArrayLike] = None,
    wave: Optional[ArrayLike] = None,
) -> Answer:
    """A smoothing kernel: moments, variance, exponential fields, faces, edges and sinusoids.

    A kernel K of unit integral over R^d, at radius r K(u/r)/r^d, smooths N independent points of density f:

      bias     = m2/(2d) r^2 lap f + m4/(8 d (d+2)) r^4 lap^2 f + ...,    m_j = int |u|^j K(u) du
      variance = (1/N) (R f/r^d - f^2 + ...),                             R = int K^2

    Lengths are in radii; all values are pure numbers. The uniform kernel also gives the images of an edge and a line.
    Source: Silverman 1986, chapter 4; the cone is Jensen 1996.

    Parameters
    ----------
    kernel : number, word or array
        uniform, epanechnikov, biweight, cone_k1 (any number for the 1), gaussian (standard deviation r, untruncated) or
        truncated_gaussian (standard deviation r/3, cut at r).
    dimension : number, word or array
        Dimension of space: 1 (beams at a ray), 2 (photons on a surface) or 3 (photons in a medium).
    gradient : number or array
        Gradient times radius of exponential fields e^(b.x), -500 to 500 (Gaussian: 35): gives the kernel's mean over
        the value at the centre.
    depth : number or array
        Depths over the radius behind a flat face (negative: outside): gives the moments M_0, M_1, M_2 of the cut kernel
        (dimension 3) and, for the uniform kernel, the images of an edge and of a line.
    wave : number or array
        Wave numbers times radius of sinusoids: gives the transfer of the kernel in three dimensions.
    """

def beams(
    *,
    kernel: _Words = 'uniform',
    radius: _Words = 1,
    density: _Words = 1,
    length: _Words = 1,
    extinction: _Words = 0,
    sine: Optional[_Words] = None,
    gradient: Optional[ArrayLike] = None,
    curvature: Optional[ArrayLike] = None,
    tail: Optional[ArrayLike] = None,
) -> Answer:
    """Beam estimates: how photons as points or beams blur and spread, asked at a point or along a ray.

      point asks points           blur in 3 dimensions, variance ~ 1/r^3
      ray asks points             blur across the ray,  variance ~ 1/r^2       (the beam radiance estimate)
      point asks beams            blur across the beams, variance ~ 1/r^2      (parallel beams)
      ray asks beams              blur along the common normal, variance ~ E[1/sin theta]/r

    bias = coefficient r^2 times the Laplacian in the directions of blur; relative variance in a uniform field

      R_d E[1/sin theta]/(density r^d S),   S = (int T ds)^2/int T^2 ds along the ray, T = e^(-extinction s)

    With `curvature`, r^(d+4) = d B/(4 A^2) is best, where bias = A r^2 and variance = B/r^d.
    Isotropic beams: E[1/sin theta] = pi/2, and X = 1/sin theta of those that cross has a tail P(X > x) ~ (4/(3 pi)) x^-3.
    Lengths in one unit of your choice; density of points per volume, of beams as their length per volume.
    Source: Jarosz, Zwicker and Jensen 2008; Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011.

    Parameters
    ----------
    kernel : number, word or array
        Kernel, by name as in `exact kernel`.
    radius : number, word or array
        Radius of the kernel, 1e-60 to 1e60.
    density : number, word or array
        Points per volume, or length of beams per volume, 1e-60 to 1e60.
    length : number, word or array
        Length of the ray, 1e-60 to 1e60.
    extinction : number, word or array
        Extinction coefficient along the ray, in 1/length, 0 or more.
    sine : number, word or array
        Sine of the angle between ray and beams, above 0 to 1: parallel beams in place of isotropic ones.
    gradient : number or array
        Gradients |b| of fields e^(b.x), times the radius: gives each estimate's mean over the truth.
    curvature : number or array
        Laplacians of the field over the field, in 1/length^2, not 0: gives the radius of least mean squared error, and
        that error, relative.
    tail : number or array
        Values x of 1/sin theta, 1 and more: gives the tail P(X > x) and the second moment of isotropic beams up to x.
    """

def nearest(
    k: _Words,
    *,
    dimension: _Words = 3,
    density: _Words = 1,
    points: Optional[_Words] = None,
    kernel: _Words = 'uniform',
    gradient: Optional[ArrayLike] = None,
    curvature: Optional[ArrayLike] = None,
    cap: Optional[_Words] = None,
) -> Answer:
    """The k nearest of independent points: what the estimate expects, how it scatters, how far it gathers.

    The rule: r_k is the distance of the k-th nearest point, the kernel of radius r_k is summed over the k - 1 nearer
    ones. For the uniform kernel that is (k-1)/(N V(r_k)), unbiased where the density is uniform; k over the same ball
    is high by k/(k-1). In the field e^(b.x) the mean is

      E = int_0^inf p_(k-2)(s) M(r(s)) ds,   p_n(s) = e^(-s) s^n/n!,   s = points expected within r,

    M(r) the kernel's mean of the field at radius r. In a field of curvature c = lap f/f, to second order in the radius,

      bias = A c E[r_k^2],   variance = R V/(k-2) + O(c),   A = m2/(2d), R the roughness, V the unit ball

    and the best k makes bias^2 + variance least. Lengths are in units of your choice, densities per unit volume.
    Source: Loftsgaarden and Quesenberry 1965; Mack and Rosenblatt 1979.

    Parameters
    ----------
    k : number, word or array
        Points gathered, 2 to 1e6 (3 and more for a variance).
    dimension : number, word or array
        Dimension of space: 1, 2 or 3.
    density : number, word or array
        Points expected per unit length, area or volume at the probe, 1e-100 to 1e100.
    points : number, word or array
        Number of points in all; without it a Poisson number.
    kernel : number, word or array
        Kernel, by name as in `exact kernel`.
    gradient : number or array
        Gradients |b| of exponential fields, in 1/length: gives the expectation over the field at the probe.
    curvature : number or array
        Laplacians of the field over the field, in 1/length^2: gives bias, variance and mean squared error to second
        order in the radius, relative, and for a curvature that is not 0 the k of least mean squared error.
    cap : number, word or array
        Largest radius of a gather; without it, six times the radius within which k points are expected.
    """

def progressive(
    *,
    dimension: _Words = 3,
    alpha: Optional[_Words] = None,
    passes: ArrayLike = (10, 100, 1000),
) -> Answer:
    """Progressive estimates: radius, variance and bias of the mean of n passes, over those of the first.

    Radii shrink from pass to pass as r_(i+1)^d = r_i^d (i + alpha)/(i + 1); each pass is a map of its own, and the
    estimate is the mean of the passes. Per pass the variance goes as r^(-d), the bias as r^2.

    All values are pure numbers. The mean squared error falls fastest with alpha = 4/(d+4), as n^(-4/(d+4)).
    Source: Hachisuka, Ogaki and Jensen 2008; Knaus and Zwicker 2011.

    Parameters
    ----------
    dimension : number, word or array
        Dimension of the blur: 1 (beams at a ray), 2 (photons on a surface) or 3 (photons in a medium).
    alpha : number, word or array
        How slowly radii shrink, above 0 to 1 (1: not at all); without it the optimum 4/(d+4).
    passes : number or array
        Numbers of passes, 1 to 1e6.
    """

def boundary(
    *,
    body: _Words = 'half-space',
    size: ArrayLike = 1,
    radius: _Words = 1,
    depth: ArrayLike = (0, 0.5, 1),
    decay: _Words = 0,
    corner: bool = False,
    behind: Optional[_Words] = None,
    kernel: _Words = 'uniform',
) -> Answer:
    """Photon estimates near a face: four treatments of the ball that the face cuts.

    With K_r of unit integral over the whole ball, z the depth along the inward normal, M_j = int K_r z^j over the
    medium and S_j = sum q_p K_r(x_p - x) z_p^j over the photons:

      none          S_0                            clipped        S_0/M_0
      reflection    S_0 + mirror images            local linear   (M_2 S_0 - M_1 S_1)/(M_0 M_2 - M_1^2)

    Photons from behind a thin wall are false: rules reject those that fly from the probe's side to the other (`facing`), the
    same of those behind the wall's plane only (`facing behind`), all behind the plane, or all that the probe cannot see
    (`visible`); `over` M_0 makes up for the part of the ball that is lost.
    Given are the expectation in a uniform field (1 is right), and in one that falls as e^(-s depth), and the variance
    over that of the whole ball in a uniform field. Lengths are in one unit of your choice.
    Source: Jones 1993 (local linear), Silverman 1986 (reflection), Jensen and Christensen 1998 (none).

    Parameters
    ----------
    body : number, word or array
        The body that the medium fills. Allowed: half-space, slab, sphere, cuboid.
    size : numbers along the last axis, in place of one number
        Thickness of the slab, radius of the sphere, or edges of the cuboid (one for a cube), 1e-12 to 1e12.
    radius : number, word or array
        Radius of the kernel, 1e-12 to 1e12.
    depth : number or array
        Depths of probes below the nearest face, inside the body; in a cuboid below the middle of a face.
    decay : number, word or array
        Decay s of the field e^(-s depth), in 1/length; 0 for the uniform field alone.
    corner : bool
        Probes of a cuboid as deep below three faces at once, at a corner.
    behind : number, word or array
        Uniform field behind a thin flat wall as far from the probe as each depth, over the field in front: gives the
        expectation over that in front with every rule that rejects photons from behind, body and treatment aside.
    kernel : number, word or array
        Kernel, by name as in `exact kernel`.
    """
