"""Photons: how many collide, what they carry, and the same ones as the program exports."""

import pathlib
import re

import numpy as np
import pytest

import turbid
from turbid import exact


def test_collisions_of_a_slab_are_exact():
    """Power over the incident one that collides: absorptance over 1 - albedo; 64 seeds, Student's t at 1e-6."""
    scene = turbid.scene("slab", tau=1, albedo=0.8, cell=2)
    answer = exact.slab(1, 0.8).absorptance.value / 0.2

    def mean(seed):
        photons, emitted = turbid.photons(scene, 8000, seed=seed)
        assert np.all(photons["power"] == photons["power"][0, 0])
        return photons["power"][:, 0].sum(dtype=float) / emitted / 4

    means = np.array([mean(seed) for seed in range(1, 65)])
    error = means.std(ddof=1) / 8
    assert abs(means.mean() - answer) < 5.42 * error, (means.mean(), answer, error)
    # It would see two per cent.
    assert error * (5.42 + 2.4) < 0.02 * answer


def test_what_a_photon_is():
    photons, emitted = turbid.photons("fogbox", 3000)
    assert turbid.PHOTON.itemsize == 64 and photons.dtype == turbid.PHOTON and emitted == 3000
    assert np.allclose(np.linalg.norm(photons["direction"], axis=1), 1, atol=1e-6)
    is_in_medium = ~photons["normal"].any(axis=1)
    assert np.all(np.sum(photons["normal"] * photons["direction"], 1)[~is_in_medium] < 1e-6)
    assert is_in_medium.any() and np.all(np.diff(is_in_medium.astype(int)) <= 0)
    classes = np.array(turbid.PHOTON_CLASSES)[photons["class"]]
    assert np.array_equal(classes[photons["order"] == 0] == "single", is_in_medium[photons["order"] == 0])
    assert set(classes[is_in_medium]) == {"single", "multiple"} and set(classes[~is_in_medium]) == {"direct", "indirect"}
    assert np.all((photons["order"] == 0) == (photons["flags"] & 6 == 0))
    photons["power"] *= 2  # The array is one's own.


def test_places_and_orders_choose():
    whole = turbid.photons("fogbox", 3000).photons
    media = turbid.photons("fogbox", 3000, at="media").photons
    surfaces = turbid.photons("fogbox", 3000, at="surfaces", threads=1).photons
    assert np.array_equal(np.concatenate([media, surfaces]), whole)
    some = turbid.photons("fogbox", 3000, orders=(1, 2)).photons
    assert np.array_equal(some, whole[(whole["order"] >= 1) & (whole["order"] <= 2)])
    assert not np.array_equal(turbid.photons("fogbox", 3000, seed=2).photons, whole)
    with pytest.raises(turbid.Error, match="at is 'air'; allowed: media, surfaces, both"):
        turbid.photons("fogbox", at="air")
    with pytest.raises(turbid.Error, match="of memory; allowed: what is free"):
        turbid.photons("fogbox", 1e12)


def test_the_same_photons_as_the_program_exports(turbid_program, tmp_path):
    """The volume map, which leaves out direct light, in another order."""
    words = ["--volume", "emit:2000", "--global", "emit:2000", "--which", "volume", "--ply", "fog.ply"]
    done = turbid_program.run("map", "fogbox", "-o", "fog.png", "--width", 16, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    head, body = (tmp_path / "fog.ply").read_bytes().split(b"end_header\n", 1)
    columns = [("place", "<f8", 3), ("direction", "<f4", 3), ("power", "<f4", 3), ("colour", "u1", 3), ("order", "<u2"), ("class", "u1")]
    kept = np.frombuffer(body, np.dtype(columns))
    photons, emitted = turbid.photons("fogbox", 2000, at="media")
    photons = photons[photons["flags"] != 0]
    assert len(photons) == len(kept) > 1000
    # Trees keep places and directions in fewer bits.
    apart = np.abs(photons["position"][:, None] - kept["place"][None]).max(2)
    nearest = apart.argmin(1)
    assert len(set(nearest)) == len(photons) and apart.min(1).max() < 1e-5
    assert np.abs(photons["direction"] - kept["direction"][nearest]).max() < 1e-5
    assert emitted == 2000 and b"comment emitted 2000\n" in head
    assert np.array_equal(photons["power"], kept["power"][nearest])
    assert np.array_equal(photons["order"], kept["order"][nearest])
    assert np.array_equal(photons["flags"], kept["class"][nearest])


def test_the_documented_tracer_feeds_the_estimators(turbid_program, tmp_path, monkeypatch):
    """The tracer in NumPy that RENDERING.md shows, 16 times: the exact fluences of its slab, by Student's t at 1e-6."""
    text = (pathlib.Path(__file__).parents[2] / "RENDERING.md").read_text()
    code = re.search("```python\n(.*?)```", text, re.S).group(1)
    monkeypatch.chdir(tmp_path)
    files = []
    for seed in range(16):
        exec(code.replace("default_rng(1)", f"default_rng({seed})"), {})
        files += ["--photons-from", pathlib.Path("photons.npy").rename(f"{seed}.npy")]
    rows = turbid_program.json("measure", "slab", "--with", "photons", *files, "--radius", 0.2, cwd=tmp_path)
    depths = np.array([0.1, 0.25, 0.5, 0.75, 0.9]) * 2
    assert len(rows) >= 5
    for row, exact_value in zip(rows[-5:], exact.slab(2, 0.9, depth=depths).fluence.value):
        # A radius of 0.2 blurs by r^2/10 times the curvature, less than two curvatures of the field's own size.
        assert abs(row["mean"] - exact_value) < 7.91 * row["std_error"] + 8e-3 * exact_value, (row, exact_value)
        assert row["std_error"] < 0.03 * exact_value
