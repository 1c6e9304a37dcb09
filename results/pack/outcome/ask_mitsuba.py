"""Answers of Mitsuba 3: python3 ask_mitsuba.py > mitsuba.csv

Asks the problems of the pack that its volumetric path tracer can, reading their scenes: fluxes by an irradiance meter, radiances by
a radiance meter. The error of an answer is that of the mean of 64 renderings, with the seeds 0 to 63.
"""

import json
import math
import sys
import time
import tomllib
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
dr.set_thread_count(1)
T = mi.ScalarTransform4f
PACK = Path(__file__).resolve().parent.parent
REPETITIONS = 64
# Half the side of a slab, over its thickness and over a mean free path.
WIDE = 1e5
# Vacuum between layers and beside meters, over the thickness of a slab: of no matter between planes without end.
GAP = 0.05
INTEGRATOR = {"type": "volpath", "max_depth": -1, "rr_depth": 20000}


def medium(keys, scale):
    phase = {"type": "rayleigh"} if "phase" in keys else {"type": "hg", "g": keys["g"]}
    if keys.get("g") == 0.0:
        phase = {"type": "isotropic"}
    return {"type": "homogeneous", "sigma_t": keys["sigma_t"] / scale, "albedo": keys["albedo"], "phase": phase}


def plane(z, side, up, **keys):
    """A square at a height of z, whose normal points to smaller z if `up`."""
    turn = T().rotate([1, 0, 0], 180.0 if up else 0.0)
    return {"type": "rectangle", "to_world": T().translate([0, 0, z]) @ turn @ T().scale([side, side, 1.0])} | keys


FILM = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance", "component_format": "float32"}
SAMPLER = {"type": "independent"}


def meter(keys):
    return keys | {"bsdf": {"type": "null"}, "sensor": {"type": "irradiancemeter", "film": FILM, "sampler": SAMPLER}}


def radiance(origin, toward):
    return {"type": "radiancemeter", "origin": origin, "direction": toward, "film": FILM, "sampler": SAMPLER}


def slab(scene):
    """A scene of slabs, its length unit, and the heights of its faces."""
    inside = {i["name"]: i for i in scene.get("interiors", [])}
    bodies = [(r["shape"]["slab"], r, None) for r in scene.get("regions", [])]
    ground = None
    for o in scene.get("objects", []):
        if "dielectric" in o["surface"]:
            keys = inside[o["surface"]["dielectric"]["inside"]]
            bodies.append((o["shape"]["slab"], keys, keys["index"] if keys["index"] != 1.0 else None))
        else:
            ground = o["surface"]["lambertian"]["reflectance"]
    thick = sum(body["thickness"] for body, _, _ in bodies)
    # A thin slab is drawn thick, in a thin medium: rays start some 1e-4 off a surface.
    scale = 1.0 / min(1.0, thick)
    side = WIDE * max(1.0, thick) * scale
    gap = GAP * thick * scale
    parts, z = {"type": "scene", "integrator": INTEGRATOR}, 0.0
    for i, (body, keys, index) in enumerate(bodies):
        bsdf = {"type": "dielectric", "int_ior": index, "ext_ior": 1.0} if index else {"type": "null"}
        faces = {"bsdf": bsdf, "interior": medium(keys, scale)}
        parts[f"top{i}"] = plane(z, side, True, **faces)
        z += body["thickness"] * scale
        parts[f"bottom{i}"] = plane(z, side, False, **faces)
        z += gap
    parts["ground"] = plane(z + gap, side, True, bsdf={"type": "diffuse", "reflectance": ground or 0.0})
    light = scene["lights"][0]
    if "beam" in light:
        beam = light["beam"]
        parts["light"] = {"type": "directional", "direction": beam["dir"], "irradiance": beam["irradiance"]}
    else:
        parts["light"] = {"type": "constant", "radiance": light["isotropic"]["radiance"]}
    return parts, -gap, z, thick


def answer_slab(scene, sensor):
    """The scene with its meter, its thickness, and what to make of the mean."""
    if any("emission" in r for r in scene.get("regions", [])) or "lights" not in scene:
        return None
    beam = scene["lights"][0].get("beam")
    refracts = any(i["index"] != 1.0 for i in scene.get("interiors", []))
    if refracts and beam:
        return None  # a beam through a smooth face is out of reach of its paths
    parts, above, below, thick = slab(scene)
    kind, keys = next(iter(sensor["measure"].items()))
    scattered = "min_order" in sensor
    if kind == "outflow" and keys["face"] == "top" and not scattered:
        parts["meter"] = meter(plane(above, 1.0, False))
    elif kind == "outflow" and keys["face"] == "bottom":
        # Paths do not run into a beam: what arrives has been scattered.
        direct = math.exp(-thick / beam["dir"][2]) if beam else 0.0
        if scattered != bool(beam) and direct * 1e8 > 1.0:
            return None
        if scattered and not beam:
            return None
        parts["meter"] = meter(plane(below, 1.0, True))
    elif kind == "radiance":
        up = keys["dir"][2] > 0.0
        parts["meter"] = radiance([0.0, 0.0, above if up else below], keys["dir"])
    else:
        return None  # there is no meter of fluence or of absorbed power
    return parts, thick, lambda x: x


def answer_sphere(scene, sensor):
    region, light = scene["regions"][0], scene["lights"][0]
    a = region["shape"]["sphere"]["radius"]
    kind, keys = next(iter(sensor["measure"].items()))
    if "volume-source" in light:
        return None  # its media do not emit
    parts = {"type": "scene", "integrator": INTEGRATOR}
    parts["ball"] = {"type": "sphere", "radius": a, "bsdf": {"type": "null"}, "interior": medium(region, 1.0)}
    if "point" in light:
        parts["light"] = {"type": "point", "position": [0.0] * 3, "intensity": light["point"]["power"] / (4.0 * math.pi)}
    else:
        parts["light"] = {"type": "constant", "radiance": light["isotropic"]["radiance"]}
    if kind == "radiance":
        parts["meter"] = radiance(keys["origin"], keys["dir"])
        return parts, a, lambda x: x
    if kind == "outflow" and "isotropic" in light:
        # Around the ball: what its surface lacks, spread over the larger one.
        wide = 1.01 * a
        parts["meter"] = meter({"type": "sphere", "radius": wide, "flip_normals": True})
        return parts, a, lambda x: 1.0 - (1.0 - x) * (wide / a) ** 2
    return None


def main():
    print("id,value,std_error")
    for file in dict.fromkeys(q["scene"] for q in json.loads((PACK / "questions.json").read_text())["questions"]):
        scene = tomllib.loads((PACK / file).read_text())
        sphere = "sphere" in scene.get("regions", [{"shape": {}}])[0]["shape"]
        for sensor in scene["sensors"]:
            if len(sys.argv) > 1 and sys.argv[1] not in sensor["name"]:
                continue
            asked = (answer_sphere if sphere else answer_slab)(scene, sensor)
            if asked is None:
                continue
            parts, thick, of = asked
            start = time.process_time()
            made = mi.load_dict(parts)
            samples = 1 << (14 if thick < 5.0 else 12 if thick < 20.0 else 9)
            found = [of(float(np.array(mi.render(made, spp=samples, seed=i)).ravel()[0])) for i in range(REPETITIONS)]
            error = np.std(found, ddof=1) / math.sqrt(REPETITIONS)
            print(f"{sensor['name']},{np.mean(found):.9g},{error:.3g}", flush=True)
            print(f"{sensor['name']} {time.process_time() - start:.1f} s", file=sys.stderr)


main()
