"""Scenes in every form, and every way of giving a wrong one."""

import pathlib

import numpy as np
import pytest

import turbid

FOG = """\
[[regions]]
shape = { sphere = { center = [0, 0, 0], radius = 1.0 } }
sigma_t = 1.0
albedo = 0.9
g = 0.0

[[lights]]
volume-source = { shape = { sphere = { center = [0, 0, 0], radius = 1.0 } }, density = 0.238732414637843 }

[[sensors]]
name = "ball"
measure = { outflow = { shape = { sphere = { center = [0, 0, 0], radius = 1.0 } }, face = "top" } }

[[sensors]]
name = "centre"
measure = { fluence = { at = [0, 0, 0] } }
"""

BALL = {"sphere": {"center": np.zeros(3), "radius": np.float64(1)}}
AS_DICT = {
    "regions": [{"shape": BALL, "sigma_t": 1, "albedo": 0.9, "g": 0}],
    "lights": ({"volume-source": {"shape": BALL, "density": 0.238732414637843}},),
    "sensors": [
        {"name": "ball", "measure": {"outflow": {"shape": BALL, "face": "top"}}},
        {"name": "centre", "measure": {"fluence": {"at": (0, 0, 0)}}},
    ],
}


def numbers(scene, **more):
    return [(row.mean, row.std_error) for row in turbid.measure(scene, samples=3000, **more)]


def test_every_form_gives_the_same_numbers(tmp_path):
    file = tmp_path / "fog.toml"
    file.write_text(FOG)
    expected = numbers(FOG)
    assert expected == numbers(AS_DICT) == numbers(file) == numbers(str(file)) == numbers(turbid.scene(file))
    named = numbers("slab", parameters=dict(tau=1, albedo=0.5))
    assert named == numbers(turbid.scene("slab", tau=1, albedo=0.5)) != numbers("slab")
    assert named[0] != expected[0]
    # Keys of a scene change as parameters do.
    changed = {"regions.0.albedo": 0.5}
    expected = numbers(FOG.replace("albedo = 0.9", "albedo = 0.5"))
    assert expected == numbers(FOG, parameters=changed) == numbers(AS_DICT, parameters=changed) == numbers(file, parameters=changed)


def test_files_of_a_scene_are_found(tmp_path, monkeypatch):
    values = "\n".join(["[[regions]]", 'shape = { cuboid = { min = [0, 0, 0], max = [1, 1, 1] } }', "sigma_t = 1.0", "albedo = 0.5", "g = 0.0",
                        'density = { grid = { file = "fog.vol" } }', "[[lights]]", "point = { position = [2, 2, 2], power = 1.0 }",
                        "[[sensors]]", 'name = "box"', "measure = { absorbed = { region = 0 } }"])
    grid = np.ones((2, 2, 2), "<f4")
    head = b"VOL\x03" + np.array([1, 2, 2, 2, 1], "<i4").tobytes() + np.array([0, 0, 0, 1, 1, 1], "<f4").tobytes()
    (tmp_path / "fog.vol").write_bytes(head + grid.tobytes())
    (tmp_path / "fog.toml").write_text(values)
    expected = numbers(tmp_path / "fog.toml")
    assert numbers(values, folder=tmp_path) == expected == numbers(turbid.scene(tmp_path / "fog.toml"))
    monkeypatch.chdir(tmp_path)
    assert numbers(values) == expected
    monkeypatch.chdir("/")
    with pytest.raises(turbid.Error, match="fog.vol"):
        numbers(values)


MITSUBA = """<scene version="3.0.0"><integrator type="volpath"/>
<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
<lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/></film></sensor>
<shape type="cube"><bsdf type="null"/><medium type="homogeneous" name="interior"><rgb name="sigma_t" value="1 2 3"/>
<rgb name="albedo" value="0.8 0.7 0.6"/></medium></shape>FLOOR<emitter type="constant"/></scene>"""


def test_scenes_of_mitsuba_are_read(tmp_path, turbid_program):
    """As the program reads them, with and without files beside them."""
    floor = '<shape type="obj"><string name="filename" value="floor.obj"/><bsdf type="diffuse"/></shape>'
    (tmp_path / "floor.obj").write_text("v -2 -1.5 2\nv 2 -1.5 2\nv 0 -1.5 -3\nf 1 2 3\n")
    for name, more in ("fog", ""), ("room", floor):
        file = tmp_path / f"{name}.xml"
        file.write_text(MITSUBA.replace("FLOOR", more))
        done = turbid_program.run("import", file, "-o", f"{name}.toml", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        with pytest.warns(UserWarning, match="gaussian") as told:
            theirs = turbid.render(file, "paths", samples=2).radiance
        assert told[0].filename == __file__
        assert theirs.mean() > 0
        assert np.array_equal(theirs, turbid.render(tmp_path / f"{name}.toml", "paths", samples=2).radiance)
        with pytest.raises(turbid.Error, match="folder says nothing"):
            turbid.render(file, "paths", folder=tmp_path)
    with pytest.warns(UserWarning):
        assert turbid.scene(tmp_path / "fog.xml") == turbid.scene(tmp_path / "fog.toml")
    with pytest.warns(UserWarning), pytest.raises(turbid.Error, match="turbid import"):
        turbid.scene(tmp_path / "room.xml")


@pytest.mark.parametrize(
    "old, new",
    [
        ("albedo = 0.9", "albedo = 1.5"),
        ("sigma_t", "sigma_s"),
        ('face = "top"', 'face = "side"'),
        ("radius = 1.0 } }\nsigma", "radius = -1.0 } }\nsigma"),
        ("at = [0, 0, 0]", "at = [0, 0, 0, 1]"),
        ("sigma_t = 1.0", "sigma_t = "),
        ("sigma_t = 1.0", 'sigma_t = "thick"'),
        ("[[lights]]", "[[lamps]]"),
        ("density = 0.238732414637843", "density = 0.0"),
        ("g = 0.0", "g = 2"),
        ("albedo = 0.9", "albedo = 0.9\nalbedo = 0.8"),
    ],
)
def test_a_wrong_file_is_told_as_the_program_tells_it(old, new, tmp_path, turbid_program):
    assert old in FOG
    (tmp_path / "fog.toml").write_text(FOG.replace(old, new))
    expected = turbid_program.error("measure", "fog.toml", "--with", "path", cwd=tmp_path)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        with pytest.raises(turbid.Error) as error:
            turbid.measure("fog.toml")
    assert str(error.value) == expected


def test_wrong_names_are_told_as_the_program_tells_them(turbid_program, tmp_path):
    for words in (["slap"], ["/nowhere/at/all.toml"], [str(tmp_path)], ["fogbox"]):
        with pytest.raises(turbid.Error) as error:
            turbid.measure(*words)
        assert str(error.value) == turbid_program.error("measure", *words, "--with", "path")


def test_wrong_dicts():
    def told(scene, **more):
        with pytest.raises(turbid.Error) as error:
            turbid.measure(scene, **more)
        return str(error.value)

    assert told({"region": []}).startswith("unknown key `region`; nearest: `regions`; allowed: ")
    endless = {}
    endless["regions"] = [endless]
    assert "deeper than 32" in told(endless)
    assert told({"regions": [{"shape": None}]}).startswith("regions: shape: a value of type NoneType; allowed: ")
    assert told({1: 2}) == "the key 1 is not text"
    assert "fits 64 bits" in told({"cell": 2**70})
    wrong = {**AS_DICT, "sensors": [{"name": "centre", "measure": {"fluence": {"at": [0, 0, 0, 0]}}}]}
    assert told(wrong) == "sensors.0.measure.fluence.at has 4 entries; allowed: 3"
    assert told("slab", parameters=dict(tua=1)).startswith("tua=1: unknown key `tua`; nearest: `tau`; allowed: albedo, ")
    assert told("slab", parameters=dict(albedo=2)).startswith("albedo=2: albedo is 2; allowed: ")
    assert told(AS_DICT, parameters=dict(tau=1)).startswith("tau=1: unknown key `tau`; nearest: ")
    assert told("-").startswith("no such scene: `./-` is neither a file nor built in")
    for wrong in (3, None, b"slab", ["slab"]):
        with pytest.raises(TypeError, match="a scene is a dict, TOML text, "):
            turbid.measure(wrong)


def test_built_in_scenes_are_told():
    assert set(turbid.builtin()) == {"slab", "sphere", "shaft", "fogbox"}
    for name, text in turbid.builtin().items():
        assert text.startswith("# ") and " = " in text and turbid.scene(name)["regions"]


def test_stubs_and_marker_are_installed():
    folder = pathlib.Path(turbid.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_turbid.pyi").exists()


def test_numbers_wider_than_those_of_python():
    wide, usual = (
        turbid.measure("slab", "paths", samples=2000, parameters={"tau": kind(1.5)}) for kind in (np.longdouble, float)
    )
    assert [one.mean for one in wide] == [one.mean for one in usual]


def test_flags_are_truth_values():
    with pytest.raises(turbid.Error, match="importance is 'no'; allowed: True or False"):
        turbid.render("fogbox", importance="no")
    with pytest.raises(turbid.Error, match="weight_windows is 0; allowed: True or False"):
        turbid.measure("slab", "paths", weight_windows=0)


def test_words_are_text():
    with pytest.raises(turbid.Error, match=r"with_ is \['paths'\]; allowed: text"):
        turbid.measure("slab", ["paths"])
    with pytest.raises(turbid.Error, match="kernel is None; allowed: text"):
        turbid.measure("slab", "photons", kernel=None)
    with pytest.raises(turbid.Error, match="edges is 2; allowed: text"):
        turbid.render("fogbox", edges=2)
