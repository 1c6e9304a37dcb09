"""Pictures: the same as the program's, layer by layer, and what they are made of."""

import numpy as np
import pytest

import exr
import turbid

LAYERS = ["emission", "direct", "caustic", "indirect", "single", "multiple"]


@pytest.mark.parametrize(
    "words, more",
    [
        (["--with", "paths", "--samples", 3], dict(with_="paths", samples=3)),
        (["--with", "bidirectional", "--samples", 3], dict(with_="bidirectional", samples=3)),
        (["--with", "light", "--samples", 20, "--maps", 2], dict(with_="light", samples=20, maps=2)),
        (["--samples", 2, "--gather-rays", 4, "--seed", 5], dict(samples=2, gather_rays=4, seed=5)),
        (
            ["--samples", 1, "--gather-rays", 0, "--maps", 2, "--global", "30000", "--volume", "emit:1e5", "--importance"],
            dict(samples=1, gather_rays=0, maps=2, global_=30_000, volume="emit:1e5", importance=True),
        ),
        (
            ["--samples", 1, "--gather-rays", 0, "--radius", 0.2, "--step", 0.3, "--step-rule", "middle", "--adapt", 0, "--kernel", "cone"],
            dict(samples=1, gather_rays=0, radius=0.2, step=0.3, step_rule="middle", adapt=0, kernel="cone"),
        ),
        (
            ["--samples", 1, "--gather-rays", 0, "--beam-radius", 0.1, "--beam-blur", "2d", "--beam-length", "whole"],
            dict(samples=1, gather_rays=0, beam_radius=0.1, beam_blur="2d", beam_length="whole"),
        ),
        (
            ["--samples", 1, "--gather-rays", 2, "--beam-radius", 0.1, "--planes", "--volume", 2000, "--importance"],
            dict(samples=1, gather_rays=2, beam_radius=0.1, planes=True, volume=2000, importance=True),
        ),
    ],
)
def test_the_same_picture_as_the_program(words, more, turbid_program, tmp_path):
    size = ["--width", 24, "--height", 20, "--threads", 1]
    done = turbid_program.run("render", "fogbox", "-o", "fog.exr", *size, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    kept = exr.read(tmp_path / "fog.exr")
    found = turbid.render("fogbox", width=24, height=20, threads=2, **more)
    assert found.radiance.shape == (20, 24, 3) and found.photons.shape == (20, 24)
    has_variance = more["samples"] > 1 or "maps" in more
    assert (found.variance is not None) == has_variance == bool(found.layer_variances)
    for number, channel in enumerate("RGB"):
        same = [("", found.radiance), *((f"{name}.", found.layers[name]) for name in LAYERS)]
        if has_variance:
            same.append(("variance.", found.variance))
            same += [(f"variance.{name}.", found.layer_variances[name]) for name in LAYERS]
        for name, image in same:
            assert np.array_equal(kept[f"{name}{channel}"], image[..., number].astype("f4")), name
    assert np.array_equal(kept["photons.N"], found.photons.astype("f4"))
    assert found.radiance.max() > 0 and np.allclose(sum(found.layers.values()), found.radiance, rtol=1e-12, atol=1e-15)


PANE = """interiors = [{ name = "glass", index = 1.5 }]
camera = { position = [0.6, -0.5, 0.5], look_at = [0, -1, 0], fov = 40, width = 8, height = 8 }
[[objects]]
shape = { rectangle = { corner = [-1, -1, 1], u = [2, 0, 0], v = [0, 0, -2] } }
surface = { lambertian = { reflectance = 0.5 } }
[[objects]]
shape = { cuboid = { min = [-1.5, -0.1, -1.5], max = [1.5, 0.1, 1.5] } }
surface = { dielectric = { inside = "glass" } }
[[lights]]
sun = { dir = [0.2, -1, 0.3], irradiance = 1, angular_radius = 3 }
"""


def test_guided_pictures(turbid_program, tmp_path):
    """Below a pane, where photons know better directions than paths do."""
    scene = tmp_path / "pane.toml"
    scene.write_text(PANE)
    words = ["--with", "paths", "--guide", 20_000, "--samples", 3, "--maps", 2, "--threads", 1]
    done = turbid_program.run("render", scene, "-o", "pane.exr", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    kept = exr.read(tmp_path / "pane.exr")
    settings = dict(with_="paths", samples=3, maps=2, threads=2)
    guided, paths = turbid.render(scene, guide=20_000, **settings), turbid.render(scene, **settings)
    for number, channel in enumerate("RGB"):
        assert np.array_equal(kept[channel], guided.radiance[..., number].astype("f4"))
    assert guided.radiance.mean() > 0 and not np.array_equal(guided.radiance, paths.radiance)


def test_the_size_follows():
    assert turbid.render("fogbox", "paths", width=12, samples=1).radiance.shape[1] == 12
    assert turbid.render("fogbox", "paths", height=10, samples=1).radiance.shape[0] == 10


def test_wrong_settings():
    def told(scene="fogbox", **more):
        with pytest.raises(turbid.Error) as error:
            turbid.render(scene, **more)
        return str(error.value)

    assert told("slab").startswith("slab: the scene has no [camera]: add one")
    assert told(with_="paths", gather_rays=0) == "gather_rays says nothing to with_ = 'paths'; allowed: with photons"
    assert told(width=0).startswith("width is 0; allowed: whole numbers from 1 to 16384")
    assert told(samples=2**32, width=8).startswith("fogbox: samples is 4294967296")
    assert told(volume=0).startswith("volume is 0") and told(volume="emit:x").startswith("volume is emit:x")
    assert told(step_rule="far").startswith("step_rule is 'far'; allowed: near-end, middle, integrated")
    assert told(near=-1).startswith("fogbox: near is -1") and told(adapt=float("nan")).startswith("fogbox: adapt is NaN")
    assert told(step=1e-12).startswith("fogbox: step is ") and told(step=-1.0).startswith("fogbox: step is -1")
    assert told(beam_length="whole").endswith("allowed: with beam_radius")
    assert told(planes=True, width=8).endswith("allowed: beams beside them (a beam radius)")
    assert told(planes=True, ray_radius=1).endswith("ray_radius reads points and planes flights; allowed: one of them")
    assert told(ray_ends="own", ray_radius=1).startswith("fogbox: ray_ends: rays end for each photon or beam in one")
    assert told(beam_length="long", beam_radius=1) == "beam_length is 'long'; allowed: sampled, whole"
    assert told(beam_radius=1, boundary="reflection").endswith("of balls; allowed of rays that are read as a whole: none, clipped")
    assert told(ray_radius=1, volume_k=20).endswith("volume_k is of balls; allowed: without ray_radius, beam_radius and planes")
    assert told(edges="soft").startswith("edges is 'soft'") and told(kernel="round").startswith("kernel is 'round'")
    assert told(width=16384, height=16384).startswith("fogbox: width, height: camera.width times camera.height")
    assert "of memory" in told(volume="emit:1e12", width=8)
