"""Studies: against the program byte by byte, in every form, in parts, and as guests of Python."""

import copy
import gc
import signal
import sys
import time

import numpy as np
import pytest

import turbid
from conftest import Program

STUDY = """\
title = "A slab"
scene = "slab"
photons = [500, 1000]
maps = 4

[axes]
albedo = [0.9]

[measure]
probes = [[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]]

[[estimators]]
radius = 0.2
kernel = ["uniform", "cone"]

[[estimators]]
k = 20

[reference]
error = 0.2
"""

AS_DICT = {
    "title": "A slab",
    "scene": "slab",
    "photons": np.array([500, 1000]),
    "maps": 4,
    "axes": {"albedo": [0.9]},
    "measure": {"probes": np.array([[2.0, 2.0, 0.1], [2.0, 2.0, 1.0]])},
    "estimators": [{"radius": 0.2, "kernel": ["uniform", "cone"]}, {"k": 20}],
    "reference": {"error": 0.2},
}


@pytest.fixture(scope="module")
def study_program():
    return Program("study")


@pytest.fixture(scope="module")
def by_program(tmp_path_factory, study_program):
    """What the program says of it: the folder, which has the study and its results, and what it prints."""
    folder = tmp_path_factory.mktemp("program")
    (folder / "study.toml").write_text(STUDY)
    done = study_program.run("study.toml", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


def same(a, b):
    return a.dtype == b.dtype and all(np.array_equal(a[n], b[n], equal_nan=a[n].dtype.kind == "f") for n in a.dtype.names)


def told(study, **more):
    with pytest.raises(turbid.Error) as error:
        turbid.study(study, **more)
    return str(error.value)


@pytest.fixture(scope="module")
def of_text():
    return turbid.study(STUDY, threads=1)


def test_tables_are_those_of_the_program(by_program, of_text, tmp_path, capfd):
    folder, said = by_program
    expected = (folder / "out" / "results.csv").read_bytes()
    of_path = turbid.study(folder / "study.toml", out=tmp_path / "path")
    of_dict = turbid.study(AS_DICT, out=str(tmp_path / "dict"), threads=2)
    for study in (of_path, of_dict, of_text):
        assert (study.out / "results.csv").read_bytes() == expected
        assert same(study.results, of_text.results)
        # The program indents its sentences; what they say of seconds is the machine's.
        sentences = [sentence.rsplit(", in ", 1)[0] for sentence in study.summary]
        assert sentences and all(f"  {sentence}" in said for sentence in sentences)
        assert study.report.read_text().startswith("<!DOCTYPE html>")
    # Maps of two sizes, and batches of paths.
    assert of_path.measured == of_dict.measured == of_text.measured > 2 * 4
    assert (of_text.out / "study.toml").read_text() == STUDY and not (of_path.out / "study.toml").exists()
    # The test of the test: another seed has other cells.
    # Its first line has times and settings, its last a digest.
    cell = "cells/own/scene000-n500-000000.csv"
    turbid.study(STUDY, out=tmp_path / "other", part=(1, 1), seed=101)
    rows = [(out / cell).read_text().splitlines()[1:-1] for out in (of_path.out, of_dict.out, tmp_path / "other")]
    assert rows[0] == rows[1] != rows[2]
    assert capfd.readouterr() == ("", "")


def test_tables_are_arrays(by_program, of_text):
    rows = of_text.results
    # Two sizes, three estimators, two places and all of them.
    assert rows.shape == (2 * 3 * 3,)
    lines = (by_program[0] / "out" / "results.csv").read_text().splitlines()
    assert ",".join(rows.dtype.names) == lines[0] and len(lines) == 1 + len(rows)
    for row, line in zip(rows.tolist(), lines[1:]):
        for value, cell in zip(row, line.split(",")):
            is_same = value == cell if isinstance(value, str) else np.isnan(value) if cell == "" else value == float(cell)
            assert is_same, (value, cell)
    assert rows.dtype["albedo"] == rows.dtype["photons"] == rows.dtype["rmse"] == np.float64
    assert np.isnan(rows["radius"]).tolist() == [not np.isnan(k) for k in rows["k"]]
    assert set(rows["unit"]) == {"W/L^2", "1"} and set(rows["kernel"]) == {"uniform", "cone"}
    assert "photon map" in of_text.costs["method"] and np.nanmin(of_text.costs["reading_seconds"]) > 0


def test_a_slab_is_known_exactly(of_text):
    places = of_text.results[of_text.results["place"] != "all"]
    assert set(places["reference_by"]) == {"exact"}
    for row in places:
        fluence = turbid.exact.slab(2, row["albedo"], depth=row["z"]).fluence
        assert abs(row["reference"] - fluence.value) <= fluence.bound + row["reference_error"]
        assert row["bias"] == pytest.approx(row["mean"] / row["reference"] - 1, abs=1e-12)
    # The test of the test: another medium's would be seen.
    assert abs(places["reference"][0] - turbid.exact.slab(2, 0.89, depth=places["z"][0]).fluence.value) > 1e-3


FOG = """\
cell = 2.0

[[regions]]
shape = { slab = { top = 0.0, thickness = 1.0 } }
sigma_t = 1.0
albedo = 0.5
g = 0.0

[[lights]]
beam = { dir = [0, 0, 1], irradiance = 1.0, section = "unbounded" }
"""


def test_a_scene_within_a_dict_and_in_a_file(tmp_path, monkeypatch):
    asked = dict(scene=turbid.scene(FOG), photons=[500], maps=4, measure=dict(probes=[[1, 1, 0.5]]), estimators=[dict(radius=0.2)])
    asked["reference"] = dict(error=0.2)
    asked["axes"] = {"regions.0.albedo": [0.75]}
    within = turbid.study(asked)
    assert set(within.results["regions.0.albedo"]) == {0.75}
    (tmp_path / "fog.toml").write_text(FOG)
    monkeypatch.chdir(tmp_path)
    # Wherever it goes, what it names is in the current folder.
    beside = turbid.study(dict(asked, scene="fog.toml"), out="far/away")
    assert same(beside.results, within.results) and beside.report.is_file()
    asked["scene"]["regions"][0]["albedo"] = 1.5
    assert told(asked) == "study.toml: scene: albedo is 1.5; allowed: 0 to 1"
    monkeypatch.chdir("/")
    assert told(dict(asked, scene="fog.toml")).startswith("study.toml: scene: cannot read fog.toml: ")


def test_parts_and_merge(by_program, tmp_path):
    expected = (by_program[0] / "out" / "results.csv").read_bytes()
    one = turbid.study(STUDY, out=tmp_path / "a", part=(1, 3))
    assert one.report is one.results is one.costs is None and one.summary == [f"part 1/3: {one.measured} cells measured"]
    turbid.study(STUDY, out=tmp_path / "a", part="2/3")
    assert told(STUDY, merge=tmp_path / "a").endswith("; allowed: the folders of all parts")
    turbid.study(STUDY, out=tmp_path / "b", part="3/3")
    merged = turbid.study(STUDY, out=tmp_path / "merged", merge=[tmp_path / "a", tmp_path / "b"])
    assert merged.measured == 0 and (merged.out / "results.csv").read_bytes() == expected
    # One folder alone is where it is concluded.
    again = turbid.study(STUDY, merge=tmp_path / "merged")
    assert again.out == tmp_path / "merged" and again.measured == 0 and same(again.results, merged.results)
    turbid.study(STUDY, out=tmp_path / "c", part="3/3", seed=7)
    assert "is of other settings" in told(STUDY, out=tmp_path / "mixed", merge=[tmp_path / "a", tmp_path / "c"])


def test_a_dry_run_writes_nothing(tmp_path):
    study = turbid.study(STUDY, out=tmp_path / "out", dry_run=True)
    assert study.out is study.report is study.results is None and not (tmp_path / "out").exists()
    assert study.summary[-1].startswith("in all ") and any("scene000-n1000" in line for line in study.summary)


def test_temporary_folders_last_as_long_as_what_was_found():
    study = turbid.study(dict(AS_DICT, photons=[500], estimators=[dict(radius=0.2)]))
    folder = study.out
    assert study.report.is_file()
    for copied in (copy.copy, copy.deepcopy):
        study = copied(study)
        gc.collect()
        assert study.report.is_file()
    del study
    gc.collect()
    assert not folder.exists()


@pytest.mark.parametrize(
    "old, new",
    [
        ("photons = ", "photon = "),
        ("[500, 1000]", "[0]"),
        ("[500, 1000]", "[500, 500]"),
        ("maps = 4", "maps = 2"),
        ("maps = 4", "maps = "),
        ('"slab"', '"none.toml"'),
        ('"slab"', "3"),
        ("[0.9]", "[1.5]"),
        ("albedo =", "albedoo ="),
        ("[2.0, 2.0, 0.1]", "[2.0, 2.0, -0.1]"),
        ("k = 20", "k = 1"),
        ('["uniform", "cone"]', '"boxy"'),
    ],
)
def test_mistakes_are_told_as_the_program_tells_them(old, new, tmp_path, study_program, monkeypatch):
    assert old in STUDY
    text = STUDY.replace(old, new, 1)
    (tmp_path / "study.toml").write_text(text)
    expected = study_program.error("study.toml", "--out", "out", cwd=tmp_path)
    monkeypatch.chdir(tmp_path)
    assert told("study.toml", out="out") == told(text, out="out") == expected
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_wrong_arguments(study_program, tmp_path):
    assert told(tmp_path / "none.toml") == study_program.error(tmp_path / "none.toml")
    assert told(dict(AS_DICT, scene=None)).startswith("scene: a value of type NoneType; allowed: ")
    assert told("scene = 'slab'\n" + "#" * 2**20) == "study.toml has 1048591 bytes; allowed: up to 1048576"
    assert told(STUDY, photons=0) == "photons is 0; allowed: a factor from 1e-6 to 1e6"
    assert told(STUDY, photons=float("nan")).startswith("photons is nan; allowed: ")
    assert told(STUDY, seed=-1).startswith("seed is -1; allowed: ")
    assert told(STUDY, threads=0).startswith("threads is 0; allowed: ")
    assert told(STUDY, out="").startswith("out is empty; allowed: ")
    assert told(STUDY, dry_run="no") == "dry_run is 'no'; allowed: True or False"
    assert told(STUDY, part="1/3").startswith("a part without out would be lost")
    for part in ("4/3", (0, 3), (1, 2, 3), "x"):
        assert "allowed: a part such as 3/16" in told(STUDY, part=part, out=tmp_path / "out")
    assert told(STUDY, part="1/3", out="x", merge=["x"]).endswith("allowed: one of them")
    assert "has no cells" in told(STUDY, out=tmp_path / "out", merge=[tmp_path / "nowhere"])
    for wrong in (3, None, ["a"], b"scene"):
        with pytest.raises(TypeError, match="a study is a dict, TOML text, "):
            turbid.study(wrong)


def test_progress_tells_of_cells(tmp_path):
    seen = []
    turbid.study(STUDY, out=tmp_path, part=(1, 1), progress=lambda stage, part: seen.append((stage, part)))
    assert seen[-1][0] == "cells" and seen[-1][1] == pytest.approx(1, abs=1e-3)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
def test_ctrl_c_keeps_what_is_measured(tmp_path, interruptible):
    """The call returns at once, and cells that were finished stay."""
    long = STUDY.replace("maps = 4", "maps = 2000")
    code = "import turbid, sys; turbid.study(sys.argv[1], out=sys.argv[2], progress=lambda *told: print(*told, flush=True))"
    words = [sys.executable, "-c", code, long, str(tmp_path / "out")]
    child = interruptible(words)
    line = ["", "0"]
    while not (line[0] == "cells" and float(line[1]) > 0):
        line = child.stdout.readline().split()
        assert line, child.communicate()
    start = time.monotonic()
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=60)
    assert time.monotonic() - start < 20
    assert child.returncode in (-signal.SIGINT, 130) and said.strip().endswith("KeyboardInterrupt"), said
    kept = len(list((tmp_path / "out" / "cells" / "own").glob("*.csv"))) - 1
    assert kept > 0 and not (tmp_path / "out" / "report.html").exists()
