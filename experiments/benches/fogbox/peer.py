"""Scenes by Mitsuba 3's volumetric path tracer, again and again: the peer of the bench `fogbox`.

Usage: peer.py VARIANT FOLDER, where FOLDER holds the box (white.obj, red.obj, green.obj, light.obj) or scenes of Mitsuba. Reads
lines `scene samples seed` (iso, hg or het is the box; clear-N is the box without fog, by the particle tracer up to N bounces, under
a lamp that reflects; any other is the file of this name) and answers each with the processor seconds of the picture on the standard
output as text, one line, and then its 128 x 128 x 3 radiances as little-endian float32.
"""

import os
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

VARIANT, FOLDER = sys.argv[1:3]
mi.set_variant(VARIANT)
dr.set_thread_count(1)
WIDTH = 128
G = {"iso": 0.0, "hg": 0.7, "het": 0.5}


def grid():
    """Extinction over the box: 32 points an axis, x fastest, mean 0.5."""
    c = (np.arange(32) + 0.5) / 32.0
    z, y, x = np.meshgrid(c, c, c, indexing="ij")
    turn = 2.0 * np.pi
    d = 1.0 + 0.6 * np.sin(turn * (1.5 * x + 0.2)) * np.cos(turn * y) * np.sin(turn * (1.2 * z + 0.1))
    d = np.maximum(0.02, d + 0.35 * np.sin(turn * (3.0 * x + 2.0 * y + 2.5 * z)))
    return 0.5 * d / d.mean()


def fog(name):
    g = G[name]
    phase = {"type": "hg", "g": g} if g else {"type": "isotropic"}
    if name == "het":
        place = mi.ScalarTransform4f().translate([-1, -1, -1]).scale([2, 2, 2])
        volume = mi.VolumeGrid(grid().astype(np.float32)[..., None])
        extinction = {"type": "gridvolume", "grid": volume, "to_world": place, "filter_type": "trilinear"}
        return {"type": "heterogeneous", "sigma_t": extinction, "albedo": 0.8, "phase": phase}
    return {"type": "homogeneous", "sigma_t": 0.5, "albedo": 0.8, "phase": phase}


def matt(file, rgb):
    bsdf = {"type": "twosided", "matt": {"type": "diffuse", "reflectance": {"type": "rgb", "value": rgb}}}
    return {"type": "obj", "filename": f"{FOLDER}/{file}", "face_normals": True, "bsdf": bsdf}


def scene(name):
    is_clear = name.startswith("clear-")
    if name not in G and not is_clear:
        return mi.load_file(f"{FOLDER}/{name}.xml")
    place = mi.ScalarTransform4f().look_at(origin=[0, 0, 0.95], target=[0, 0, 0], up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": WIDTH, "height": WIDTH, "rfilter": {"type": "box"}}
    film |= {"pixel_format": "rgb", "component_format": "float32"}
    camera = {"type": "perspective", "fov": 80.0, "fov_axis": "x", "near_clip": 1e-3, "to_world": place}
    light = {"type": "area", "radiance": {"type": "rgb", "value": [18.387, 13.9873, 6.75357]}}
    reflectance = 0.8 if is_clear else 0.0
    body = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [reflectance] * 3}}
    integrator = {"type": "volpath", "max_depth": -1, "rr_depth": 5}
    if is_clear:
        bounces = int(name.removeprefix("clear-"))
        integrator = {"type": "ptracer", "max_depth": bounces, "rr_depth": 1000}
    medium = {} if is_clear else {"medium": fog(name)}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "camera": camera | {"film": film, "sampler": {"type": "independent"}} | medium,
            "white": matt("white.obj", [0.885809, 0.698859, 0.666422]),
            "red": matt("red.obj", [0.570068, 0.0430135, 0.0443706]),
            "green": matt("green.obj", [0.105421, 0.37798, 0.076425]),
            "light": {
                "type": "rectangle",
                "to_world": mi.ScalarTransform4f()
                .translate([0.0, 0.99, 0.01])
                .rotate([1, 0, 0], 90)
                .scale([0.23, 0.19, 1.0]),
                "bsdf": body,
                "emitter": light,
            },
        }
    )


def main():
    # What is rendered for long tells of it on the standard output.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    scenes = {}
    for line in sys.stdin:
        name, samples, seed = line.split()
        if name not in scenes:
            scenes[name] = scene(name)
        start = time.process_time()
        image = np.array(mi.render(scenes[name], spp=int(samples), seed=int(seed)), dtype="<f4")[..., :3]
        seconds = time.process_time() - start
        answers.write(f"{seconds!r}\n".encode() + image.tobytes())
        answers.flush()


main()
