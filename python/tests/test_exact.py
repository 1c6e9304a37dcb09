"""Exact values: against printed ones, against the program, and against themselves one by one."""

import inspect
import itertools
import pathlib

import numpy as np
import pytest

import turbid
from turbid import _stubs, exact


def test_printed_values():
    """van de Hulst 1980, table 35; Sood, Forster and Parsons 2003; Hopf 1934: to half a unit of the last digit printed."""
    slab = exact.slab(2, 0.9, g=0.75)
    assert abs(slab.reflectance.value - 0.09739) < 5e-6 + slab.reflectance.bound
    assert abs(slab.transmittance.value - 0.66096) < 5e-6 + slab.transmittance.bound
    slabs = exact.critical([1.3, 1.4])
    assert np.all(np.abs(slabs["size"].value - [0.93772556, 0.73660355]) < 1e-8)
    sphere = exact.critical([1.3, 1.4], shape="sphere", x=0.5)
    assert abs(sphere.flux_ratio.value[0] - 0.74553332) < 1.01e-8
    assert np.all(np.abs(sphere["size"].value - [2.4248249802, 1.9853434324]) < 1e-10)
    milne = exact.half_space(1, milne=True)
    assert abs(milne.extrapolation_length.value - 0.710446089598763) < 1e-14
    # The test of the test: half a per cent of g would be seen.
    assert abs(exact.slab(2, 0.9, g=0.75 * 1.005).reflectance.value - 0.09739) > 1e-4


# One question of each problem as words of the command line and as arguments.
QUESTIONS = {
    "slab": (["--tau=1.5", "--albedo=0.9", "--g=0.5", "--depth=0.3", "--mu=-0.2"], dict(tau=1.5, albedo=0.9, g=0.5, depth=0.3, mu=-0.2)),
    "layers": (
        ["--layer=tau=1,albedo=0.9,g=0.5", "--layer=tau=0,albedo=0,index=1.5", "--ground=0.3", "--depth=0.5"],
        dict(layer=[dict(tau=1, albedo=0.9, g=0.5), "tau=0,albedo=0,index=1.5"], ground=0.3, depth=0.5),
    ),
    "half_space": (["--albedo=0.7", "--mu=0.3", "--depth=1.1"], dict(albedo=0.7, mu=0.3, depth=1.1)),
    "thick": (["--albedo=0.99", "--g=0.8", "--tau=30", "--u=0.2"], dict(albedo=0.99, g=0.8, tau=30, u=0.2)),
    "two_stream": (["--tau=1", "--albedo=0.8", "--depth=0.1"], dict(tau=1, albedo=0.8, depth=0.1)),
    "xy": (["--tau=1", "--albedo=0.9", "--mu0=0.6"], dict(tau=1, albedo=0.9, mu0=0.6)),
    "sphere": (["--radius=1", "--albedo=0.9", "--source=centre", "--r=0.3"], dict(radius=1, albedo=0.9, source="centre", r=0.3)),
    "cuboid": (["--sides=1,2,1.5", "--albedo=0.5", "--at=0.5,0.5,1"], dict(sides=(1, 2, 1.5), albedo=0.5, at=(0.5, 0.5, 1))),
    "emitting_cube": (["--at=0.5,0.5,1"], dict(at=[0.5, 0.5, 1])),
    "nested": (
        ["--cuboid=x=0:2,y=0:2,z=0:2,extinction=0.3", "--source=x=0:1,y=0:1,z=0:1", "--mirror=xy", "--at=1.5,0.5,0.5"],
        dict(
            cuboid=dict(x=(0, 2), y=(0, 2), z=(0, 2), extinction=0.3),
            source=dict(x=(0, 1), y=(0, 1), z=(0, 1)),
            mirror="xy",
            at=(1.5, 0.5, 0.5),
        ),
    ),
    "cavity": (["--wall-albedo=0.5", "--albedo=0.3", "--r=0.2"], dict(wall_albedo=0.5, albedo=0.3, r=0.2)),
    "critical": (["--secondaries=1.1", "--shape=sphere", "--x=0.3"], dict(secondaries=1.1, shape="sphere", x=0.3)),
    "path": (["--shape=cuboid", "--size=1,2,3"], dict(shape="cuboid", size=[1, 2, 3])),
    "infinite": (["--albedo=0.9", "--g=0.3", "--r=2", "--scatterings=4"], dict(albedo=0.9, g=0.3, r=2, scatterings=4)),
    "kernel": (["--kernel=cone_k1", "--dimension=2", "--gradient=0.1"], dict(kernel="cone_k1", dimension=2, gradient=0.1)),
    "beams": (["--length=2", "--gradient=0.1", "--tail=3"], dict(length=2, gradient=0.1, tail=3)),
    "nearest": (["--k=50", "--curvature=-0.2"], dict(k=50, curvature=-0.2)),
    "progressive": ([], {}),
    "boundary": (["--body=slab", "--size=2", "--depth=0.25", "--behind=2"], dict(body="slab", size=2, depth=0.25, behind=2)),
}


@pytest.mark.parametrize("problem", exact._PROBLEMS)
def test_every_problem_answers_as_the_program(problem, exact_program):
    words, arguments = QUESTIONS[problem]
    rows = exact_program.json(problem.replace("_", "-"), *words)["values"]
    answer = getattr(exact, problem)(**arguments)
    assert set(answer) == {row["quantity"] for row in rows}
    for quantity, value in answer.items():
        same = [row for row in rows if row["quantity"] == quantity]
        assert np.ravel(value.value).tolist() == [row["value"] for row in same], quantity
        if problem != "progressive":
            assert np.ravel(value.bound).tolist() == [row["error"] for row in same], quantity
        assert {row["unit"] for row in same} == {value.unit}
        for name, places in value.at.items():
            assert np.ravel(places).tolist() == [row.get(name) for row in same]


def test_arguments_broadcast():
    tau, albedo, depth = np.array([[1.0], [4.0]]), 0.9, np.array([0.0, 0.5, 1.0])
    slab = exact.slab(tau, albedo, g=0.3, depth=depth)
    assert slab.fluence.value.shape == slab.fluence.bound.shape == slab.fluence.at["t"].shape == (2, 3)
    assert slab.reflectance.value.shape == (2, 1) and not slab.reflectance.at
    for i, j in itertools.product(range(2), range(3)):
        one = exact.slab(float(tau[i, 0]), albedo, g=0.3, depth=float(depth[j]))
        assert isinstance(one.fluence.value, float)
        assert abs(one.fluence.value - slab.fluence.value[i, j]) <= one.fluence.bound + slab.fluence.bound[i, j]
        assert abs(one.reflectance.value - slab.reflectance.value[i, 0]) <= 2 * one.reflectance.bound
    words = exact.sphere(1, 0.9, source=["uniform", "centre"])
    assert words.escape.value.shape == (2,) and words.escape.value[0] > words.escape.value[1]
    mixed = exact.slab(1, 0.5, mu0=["diffuse", 1.0]).reflectance.value
    assert mixed[0] == exact.slab(1, 0.5, mu0="diffuse").reflectance.value
    places = exact.emitting_cube(at=[[0.5, 0.5, 0.5], [0.5, 0.5, 1.0]])
    assert places.fluence.value.shape == (2,) and places.fluence.at["z"].tolist() == [0.5, 1.0]
    # A net flux is given at a wall alone.
    assert np.isnan(places.flux.value).tolist() == [True, False]
    for kind in (np.float32, np.int64, list, tuple):
        given = kind([1, 2]) if kind in (list, tuple) else np.array([1, 2], kind)
        assert exact.slab(given, 0.5).reflectance.value.tolist() == exact.slab([1.0, 2.0], 0.5).reflectance.value.tolist()


def test_several_values_of_one_question_are_along_the_last_axis():
    layers = exact.layers([dict(tau=1, albedo=0.9), dict(tau=2, albedo=0.5)], mu0=[0.5, 1.0])
    assert layers.absorptance.value.shape == (2, 2) and layers.reflectance.value.shape == (2,)
    sums = layers.reflectance.value + layers.absorptance.value.sum(-1) + layers.absorptance_ground.value
    assert np.all(np.abs(sums - 1) < 1e-12)
    models = exact.two_stream(1, 0.9, depth=[0.1, 0.5]).fluence
    assert models.value.shape == models.at["model"].shape == (2, 5)
    assert models.at["model"][0, 0] == "exact"
    # A direction that the formula leaves out.
    xy = exact.xy(1, 0.9, mu0=0.6, mu=[0.5, 0.6])
    assert np.isnan(xy.radiance_down.value).tolist() == np.isnan(xy.radiance_down.bound).tolist() == [False, True]
    assert exact.progressive().radius_ratio.at["passes"].tolist() == [10, 100, 1000]


def test_answers_are_read_by_name():
    answer = exact.slab(1, 0.9)
    assert answer["reflectance"] is answer.reflectance and len(answer) == len(list(answer))
    assert "reflectance" in dir(answer) and "incident power" in repr(answer)
    with pytest.raises(AttributeError, match="the answer has no reflectanse; it has: reflectance, "):
        answer.reflectanse


def test_mistakes_are_told_as_the_program_tells_them(exact_program):
    def told(*given, **more):
        with pytest.raises(turbid.Error) as error:
            exact.slab(*given, **more)
        return str(error.value)

    assert told(1, 1.5) == exact_program.error("slab", "--tau", 1, "--albedo", 1.5) == "albedo is 1.5; allowed: 0 to 1"
    assert told(np.nan, 0.5) == exact_program.error("slab", "--tau", "nan", "--albedo", 0.5)
    assert told(1, 0.5, mu0="up") == "mu0 is 'up'; allowed: a number above 0 to 1, or diffuse"
    assert told(1, 0.5, depth="x") == "depth is 'x'; allowed: a number"
    assert told(1, 0.5, order=0.5) == "order is '0.5'; allowed: a whole number"
    assert told(1, 0.5, moments="/nowhere/at/all") == exact_program.error(
        "slab", "--tau", 1, "--albedo", 0.5, "--moments", "/nowhere/at/all"
    )
    assert told([1, 2], [0.1, 0.2, 0.3]) == "arguments do not broadcast to one shape: tau (2,), albedo (3,)"
    assert told(1, 0.5, depth=[]).startswith("an argument is an empty array")
    assert "cannot be used with" in told(1, 0.5, g=0.1, rayleigh=True)
    with pytest.raises(TypeError, match="missing a required argument: 'albedo'"):
        exact.slab(1)
    with pytest.raises(TypeError, match="unexpected keyword argument 'alebdo'"):
        exact.slab(1, 0.5, alebdo=1)
    for word in ("False", 1, np.array([True, False])):
        with pytest.raises(turbid.Error, match="rayleigh is .*; allowed: True or False"):
            turbid.exact.slab(2.0, 0.5, rayleigh=word)
    with pytest.raises(turbid.Error, match="tau is a masked array; "):
        turbid.exact.slab(np.ma.array([1.0, 2.0], mask=[0, 1]), 0.5)
    with pytest.raises(turbid.Error, match="problem is 'cylinder'; allowed: slab, "):
        exact.ask("cylinder")
    with pytest.raises(turbid.Error, match="slab has no argument '--help'"):
        exact.ask("slab", **{"--help": 1})


def test_functions_say_what_they_take():
    signature = inspect.signature(exact.slab)
    assert list(signature.parameters)[:2] == ["tau", "albedo"] and signature.parameters["mu0"].default == 1
    for problem in exact._PROBLEMS:
        text = getattr(exact, problem).__doc__
        assert "Source: " in text and "Parameters\n" in text, problem
        assert "--" not in text.replace("----------", ""), problem


def test_stubs_are_those_of_the_functions():
    kept = pathlib.Path(exact.__file__).with_name("exact.pyi").read_text()
    assert kept == _stubs.stubs(), "python -m turbid._stubs > turbid/exact.pyi writes it anew"
