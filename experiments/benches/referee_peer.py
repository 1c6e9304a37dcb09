"""One slab by PythonicDISORT, again and again: the peer of the bench `referee`.

Reads lines `streams repeats` and answers each with the processor seconds of one solution (the mean over the repeats),
then R, T (direct light included) and the fluence at ten depths: what the bench asks of the referee for the same slab,
thickness 1, albedo 0.9, g = 0.75, a beam of cosine 0.6 and unit irradiance on the face.
"""

import os
import sys

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import time  # noqa: E402

import numpy as np  # noqa: E402
from PythonicDISORT.pydisort import pydisort  # noqa: E402

TAU, ALBEDO, G, MU0 = 1.0, 0.9, 0.75, 0.6
DEPTHS = (np.arange(10) + 0.5) / 10.0 * TAU


def solve(streams):
    moments = G ** np.arange(streams + 1)
    # Flux through the face is mu0 I0: unit irradiance.
    mu, up, down, mean = pydisort(
        TAU,
        ALBEDO,
        streams,
        moments,
        MU0,
        1.0 / MU0,
        0.0,
        only_flux=True,
        f_arr=moments[streams],
    )[:4]
    reflected = up(0.0)
    transmitted = sum(down(TAU))
    # The azimuthal mean at the nodes: Gauss's rule on each hemisphere, down the second.
    nodes, weights = np.polynomial.legendre.leggauss(streams // 2)
    weights = np.concatenate([weights, weights]) / 2.0
    order = np.argsort(np.abs(mu[: streams // 2]))
    assert np.allclose(np.abs(mu[: streams // 2])[order], (nodes + 1.0) / 2.0)
    values = mean(DEPTHS)
    place = np.concatenate([order, streams // 2 + order])
    diffuse = 2.0 * np.pi * (weights[:, None] * values[place]).sum(axis=0)
    # delta-M counts part of the scattered light as direct: e^(-t'/mu0) of the scaled depth. It is in no radiance.
    f = moments[streams]
    fluence = diffuse + np.exp(-(1.0 - ALBEDO * f) * DEPTHS / MU0) / MU0
    return reflected, transmitted, fluence


def main():
    for line in sys.stdin:
        streams, repeats = map(int, line.split())
        start = time.process_time()
        for _ in range(repeats):
            reflected, transmitted, fluence = solve(streams)
        seconds = (time.process_time() - start) / repeats
        print(" ".join(repr(float(x)) for x in [seconds, reflected, transmitted, *fluence]), flush=True)


main()
