"""Answers of PythonicDISORT: python3 ask_pythonicdisort.py [STREAMS] > pythonicdisort.csv, 64 streams if none are given.

Asks the slabs and layers of the pack that it can, reading their scenes; the error of an answer is its difference to that at half
the streams, and at least the 1e-12 of roundings. delta-M scaling and the corrections of Nakajima and Tanaka are on.
"""

import json
import math
import sys
import tomllib
from pathlib import Path

import numpy as np
from PythonicDISORT import pydisort
from PythonicDISORT.subroutines import generate_diff_act_flux_funcs, interpolate

PACK = Path(__file__).resolve().parent.parent


def moments(region, count):
    if "phase" in region:  # Rayleigh
        return np.array([1.0, 0.0, 0.1] + [0.0] * (count - 3))
    return region["g"] ** np.arange(count)


def solve(scene, streams):
    """Flux upwards, downwards (all of it), fluence, radiance, at a depth; None if it is not a problem of PythonicDISORT."""
    inside = {i["name"]: i for i in scene.get("interiors", [])}
    bodies = [o for o in scene.get("objects", []) if "dielectric" in o["surface"]]
    regions = scene.get("regions", []) + [inside[b["surface"]["dielectric"]["inside"]] | b for b in bodies]
    if any("slab" not in r["shape"] or r.get("index", 1.0) != 1.0 for r in regions):
        return None
    if any(r["albedo"] == 1.0 for r in regions):
        return None  # refused: the albedo must be below 1
    bottoms = np.cumsum([r["shape"]["slab"]["thickness"] for r in regions])
    albedo = np.array([r["albedo"] for r in regions])
    terms = np.array([moments(r, streams + 512) for r in regions])
    light = (scene.get("lights") or [{}])[0]
    beam = light.get("beam")
    mu0, irradiance = (beam["dir"][2], beam["irradiance"]) if beam else (1.0, 0.0)
    ground = [o["surface"]["lambertian"]["reflectance"] for o in scene.get("objects", []) if o not in bodies]
    emission = np.array([[r.get("emission", 0.0) / (1.0 - r["albedo"])] for r in regions])
    mu, up, down, mean, full = pydisort(
        bottoms,
        albedo,
        streams,
        terms,
        mu0,
        irradiance,
        0.0,
        f_arr=terms[:, streams],
        NT_cor=True,
        b_neg=light["isotropic"]["radiance"] if "isotropic" in light else 0.0,
        BDRF_Fourier_modes=ground,
        s_poly_coeffs=emission if emission.any() else np.array([[]]),
    )
    act_up, act_down = generate_diff_act_flux_funcs(mean)
    radiance = interpolate(full, NT_cor="eval" if beam else False)

    def direct(t):
        return irradiance * math.exp(-t / mu0)

    return {
        "tau": bottoms[-1],
        # Optical depth of a height: there is clear space between layers.
        "depth": lambda z: sum(min(max(z - r["shape"]["slab"]["top"], 0.0), r["shape"]["slab"]["thickness"]) for r in regions),
        "tops": [0.0, *bottoms],
        "up": lambda t: float(up(t)),
        "down": lambda t: float(sum(down(t))),
        "direct": lambda t: mu0 * direct(t) if beam else None,
        "fluence": lambda t: float(act_up(t) + act_down(t)) + direct(t),
        # Where light comes from, upwards positive, to where it goes: the sensor looks against it.
        "radiance": lambda t, d: float(radiance(d[2], t, math.atan2(-d[1], -d[0]) % (2.0 * math.pi))),
        "power": sum(4.0 * math.pi * r.get("emission", 0.0) * r["shape"]["slab"]["thickness"] for r in regions),
    }


def answer(slab, sensor):
    kind, keys = next(iter(sensor["measure"].items()))
    if kind == "outflow":
        power = slab["power"] or 1.0
        if keys["face"] == "top":
            return slab["up"](0.0) / power
        total = slab["down"](slab["tau"])
        if "min_order" not in sensor:
            return total / power
        return None if slab["direct"](0.0) is None else total - slab["direct"](slab["tau"])
    if kind == "absorbed":
        net = [slab["down"](t) - slab["up"](t) for t in slab["tops"][keys["region"] :][:2]]
        return net[0] - net[1]
    if kind == "fluence":
        return slab["fluence"](slab["depth"](keys["at"][2]))
    return slab["radiance"](slab["depth"](keys["origin"][2]), keys["dir"])


def main(streams):
    print("id,value,std_error")
    for file in dict.fromkeys(q["scene"] for q in json.loads((PACK / "questions.json").read_text())["questions"]):
        scene = tomllib.loads((PACK / file).read_text())
        solved = [solve(scene, n) for n in (streams, streams // 2)]
        for sensor in scene["sensors"] if solved[0] else []:
            fine, coarse = (answer(slab, sensor) for slab in solved)
            if fine is not None:
                print(f"{sensor['name']},{fine!r},{max(abs(fine - coarse), 1e-12 * abs(fine)):.3g}", flush=True)


main(int(sys.argv[1]) if len(sys.argv) > 1 else 64)
