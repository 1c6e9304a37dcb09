"""Measurements: against exact values, against the program bit by bit, and as guests of Python."""

import signal
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import turbid
from turbid import exact

# Two-sided at 1e-6: of normal numbers, which means of 10^5 paths are, and of Student's t with 63 degrees of freedom.
NORMAL, STUDENT_63 = 4.89, 5.42

BINS = {
    "cell": 2.0,
    "regions": [{"shape": {"slab": {"top": 0, "thickness": 2}}, "sigma_t": 1, "albedo": 0.9, "g": 0}],
    "lights": [{"beam": {"dir": [0, 0, 1], "irradiance": 1, "section": "unbounded"}}],
    "sensors": [
        {
            "name": "layers",
            "measure": {"mean-fluence": {"min": [0, 0, 0], "max": [2, 2, 2], "cells": [1, 2, 4]}},
        }
    ],
}


def scores(found, albedo, names):
    slab = exact.slab(2, albedo)
    return [(found["slab", name].mean - slab[name].value) / found["slab", name].std_error for name in names]


@pytest.mark.parametrize("with_", ["paths", "light", "photons"])
def test_fluxes_of_a_slab_are_exact(with_):
    names = ["reflectance", "transmittance", "transmittance_diffuse", "absorptance"]
    much = dict(samples=2e5) if with_ in ("paths", "bidirectional") else dict(photons=2e5)
    scene = {**turbid.scene("slab"), "sensors": turbid.scene("slab")["sensors"][:4]} if with_ == "light" else "slab"
    found = turbid.measure(scene, with_, seed=11, **much)
    z = scores(found, 0.9, names)
    assert np.max(np.abs(z)) < NORMAL, z
    # The test of the test: an albedo 0.01 too high would be seen.
    assert np.max(np.abs(scores(found, 0.91, names))) > 2 * NORMAL


def test_fluences_of_paths_are_exact():
    found = turbid.measure("slab", samples=2e5, seed=12)
    depths = np.array([0.1, 0.25, 0.5, 0.75, 0.9]) * 2
    fluence = exact.slab(2, 0.9, depth=depths).fluence
    z = [(row.mean - value) / row.std_error for row, value in zip(found[4:], fluence.value)]
    assert np.max(np.abs(z)) < NORMAL, z
    assert np.max([row.std_error / row.mean for row in found[4:]]) < 0.02
    assert found[4].sensor == "depth 0.2" and found[4].unit == "W/L^2" and found[4].n == 200_000


def test_bins_of_light_tracing_are_exact():
    """Means over layers, against Gauss's rule with eight nodes a layer of the exact fluence."""
    found = turbid.measure(BINS, "light", photons=2e5, seed=13)["layers"]
    assert found.mean.shape == found.std_error.shape == (1, 2, 4) and found.middle.shape == (1, 2, 4, 3)
    assert found.middle[0, 1, 2].tolist() == [1.0, 1.5, 1.25]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    depths = 0.25 + 0.5 * np.arange(4)[:, None] + 0.25 * nodes
    means = exact.slab(2, 0.9, depth=depths).fluence.value @ weights / 2
    z = (found.mean - means) / found.std_error
    assert np.max(np.abs(z)) < NORMAL, z
    assert found.n == 200_000 and np.all(found.std_error / found.mean < 0.02)


@pytest.mark.parametrize(
    "words, more",
    [
        (["--with", "path", "--samples", "5000"], dict(with_="paths", samples=5000)),
        (["--with", "path", "--samples", "5e3", "--orders", "1..2"], dict(samples=5e3, orders="1..2")),
        (
            ["--with", "photons", "--photons", "30000", "--maps", "4", "--k", "20", "--kernel", "cone", "--seed", "7"],
            dict(with_="photons", photons=30_000, maps=4, k=20, kernel="cone", seed=7),
        ),
        (
            ["--with", "photons", "--photons", "3e4", "--radius", "0.3", "--passes", "3", "--boundary", "none"],
            dict(with_="photons", photons=3e4, radius=0.3, passes=3, boundary="none"),
        ),
        (
            ["--with", "photons", "--photons", "3e4", "--maps", "3", "--radius", "0.3", "--progressive"],
            dict(with_="photons", photons=3e4, maps=3, radius=0.3, progressive=True),
        ),
    ],
)
def test_the_same_bits_as_the_program(words, more, turbid_program):
    rows = turbid_program.json("measure", "slab", "--set", "albedo=0.7", "--threads", 1, *words)
    found = turbid.measure("slab", parameters=dict(albedo=0.7), threads=2, **more)
    assert len(rows) == len(found)
    for row, mine in zip(rows, found):
        assert (row["sensor"], row["quantity"], row["unit"], row["n"]) == (mine.sensor, mine.quantity, mine.unit, mine.n)
        assert row["mean"] == mine.mean, mine
        if mine.why:
            assert row["std_error"] == mine.why and np.isnan(mine.std_error)
        else:
            assert row["std_error"] == mine.std_error, mine


def test_bins_and_colours_as_the_program_writes_them(turbid_program, tmp_path):
    colored = turbid.scene(BINS)
    colored["regions"][0]["albedo"] = [0.9, 0.5, 0.1]
    text = """
        cell = 2.0
        [[regions]]
        shape = { slab = { top = 0.0, thickness = 2.0 } }
        sigma_t = 1.0
        albedo = [0.9, 0.5, 0.1]
        g = 0.0
        [[lights]]
        beam = { dir = [0, 0, 1], irradiance = 1.0, section = "unbounded" }
        [[sensors]]
        name = "layers"
        measure = { mean-fluence = { min = [0, 0, 0], max = [2, 2, 2], cells = [1, 2, 4] } }
    """
    (tmp_path / "fog.toml").write_text(textwrap.dedent(text))
    for with_, program in (("light", "light"), ("photons", "photons"), ("paths", "path")):
        more = dict(samples=100, seed=3) if with_ == "paths" else dict(photons=20_000, seed=3)
        much = ["--samples", 100] if with_ == "paths" else ["--photons", 20_000]
        words = [*much, "--seed", 3, "--npy", "bins.npy"]
        done = turbid_program.run("measure", "fog.toml", "--with", program, *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        kept = np.load(tmp_path / "bins.npy")
        found = turbid.measure(colored, with_, **more)["layers"]
        assert found.mean.shape == (1, 2, 4, 3) and found.quantity == "fluence"
        assert np.array_equal(kept[..., 0], found.mean)
        assert np.array_equal(kept[..., 1], found.std_error, equal_nan=True)


def test_what_has_no_error_says_why():
    found = turbid.measure("slab", "photons", photons=1000, maps=1)
    assert found[4].why == "one-map" and np.isnan(found[4].std_error) and found[0].why == ""
    assert found.estimates["made"] == 5 and found.ledger is not None
    assert abs(sum(found.ledger.values()) - 1) < 1e-9
    assert "slab  reflectance" in repr(found)
    with pytest.raises(KeyError, match="names 0 measurements; there are: "):
        found["slab", "reflectanse"]
    with pytest.raises(KeyError, match="names 4 measurements"):
        found["slab"]


def test_wrong_settings():
    def told(**more):
        with pytest.raises(turbid.Error) as error:
            turbid.measure("slab", **more)
        return str(error.value)

    assert told(with_="magic") == "with_ is 'magic'; allowed: paths, path, bidirectional, photons, light"
    assert told(samples=0).startswith("samples is 0; allowed: whole numbers from 1")
    for wrong in (1.5, -1, "many", True, float("nan"), float("inf"), 1e30, None):
        assert told(samples=wrong).startswith("samples is ")
    assert told(seed=-1).startswith("seed is -1; allowed: whole numbers from 0")
    assert told(threads=0).startswith("threads is 0")
    assert told(with_="photons", kernel="round").startswith("kernel is 'round'; allowed: uniform, ")
    assert told(with_="photons", boundary="soft").startswith("boundary is 'soft'; allowed: none, clipped, ")
    assert told(with_="photons", radius=-1).startswith("slab: radius: ")
    assert told(with_="photons", ray_radius=0).startswith("slab: ray_radius is 0; allowed: ")
    assert told(with_="photons", beam_radius=0).startswith("slab: beam_radius is 0; allowed: ")
    assert told(with_="photons", beam_radius=1, ray_radius=1).endswith("allowed: one of them")
    assert told(with_="photons", ray_k=5).endswith("allowed: with it, and not progressive, where radii shrink")
    assert told(with_="photons", ray_radius=1, ray_k=0).startswith("ray_k is 0; allowed: whole numbers from 1")
    assert told(with_="photons", beam_blur="4d", beam_radius=1) == "beam_blur is '4d'; allowed: 1d, 2d, 3d"
    assert told(with_="photons", beam_length="whole").endswith("allowed: with beam_radius")
    assert "with radius, ray_radius or beam_radius" in told(with_="photons", progressive=True)
    assert told(with_="paths", radius=1) == "radius says nothing to with_ = 'paths'; allowed: with photons"
    assert told(with_="light", samples=9) == "samples says nothing to with_ = 'light'; allowed: with paths or path or bidirectional"
    assert told(with_="photons", radius=1, k=3).startswith("radius takes all photons")
    assert told(with_="photons", k=1).startswith("slab: k, max_radius: ")
    assert told(with_="photons", passes=2).startswith("slab: the k nearest photons of a map cannot be found in passes")
    assert told(with_="photons", photons=3).endswith("at least one for each of the 16 maps")
    assert told(with_="photons", weight_windows=True).startswith("weight_windows splits paths")
    assert told(with_="photons", guide=1e4) == "guide says nothing to with_ = 'photons'; allowed: with paths or path"
    assert told(guide=1e4, weight_windows=True) == "weight_windows and guide both lead paths; allowed: one of them"
    assert told(guide=0).startswith("guide is 0; allowed: ") and "10000000" in told(guide=1e8)
    assert told(with_="light").startswith("slab: sensor depth 0.2: light tracing measures means over bins")
    for bomb in (dict(with_="photons", photons=1e14), dict(with_="photons", photons=9e15, radius=1e-3)):
        assert "of memory; allowed: what is free" in told(**bomb)
    for wrong in ("x", -1, (3, 1), 65535, (1, 2, 3), 1.5, "1..x"):
        assert told(orders=wrong).startswith(f"orders is {wrong!r}; allowed: ")


def test_progress_is_told_and_may_stop_the_work(capfd):
    heard = []
    turbid.measure("slab", samples=1e5, threads=1, progress=lambda stage, part: heard.append((stage, part)))
    assert heard and all(stage == "paths" and 0 <= part <= 1 for stage, part in heard)
    assert [part for _, part in heard] == sorted(part for _, part in heard)

    def stop(stage, part):
        raise RuntimeError("enough")

    start = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        turbid.measure("slab", samples=1e8, progress=stop)
    assert time.monotonic() - start < 30
    assert capfd.readouterr() == ("", "")
    turbid.measure("slab", samples=1000, progress=True)
    exact.ask("slab", tau=1, albedo=[0.1, 0.2], progress=True)
    said = capfd.readouterr()
    assert said.out == "" and "turbid: paths 100 %" in said.err and "turbid: questions 100 %" in said.err


def test_others_run_meanwhile():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        before = counted[0]
        start = time.monotonic()
        turbid.measure("slab", samples=1e5, threads=1)
        seconds = time.monotonic() - start
    finally:
        done.set()
        thread.join()
    # Were it held, the other thread would count once or twice.
    assert counted[0] - before > 20 * min(seconds, 1)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize(
    "call",
    [
        "turbid.measure('slab', samples=1e8)",
        "turbid.photons('fogbox', 1e9, orders=9999)",
        "turbid.render('fogbox', 'paths', samples=4e9)",
        "turbid.exact.slab(numpy.linspace(1, 300, 10**5), 0.9, g=0.9)",
    ],
)
def test_ctrl_c_ends_the_work(call, interruptible):
    code = f"import numpy, turbid, sys; print('begun', flush=True); {call}"
    child = interruptible([sys.executable, "-c", code])
    assert child.stdout.readline() == "begun\n"
    time.sleep(1)
    start = time.monotonic()
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=60)
    # Generous: a machine may be busy.
    assert time.monotonic() - start < 20
    assert child.returncode in (-signal.SIGINT, 130) and said.strip().endswith("KeyboardInterrupt"), said
