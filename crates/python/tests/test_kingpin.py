"""Wheels against the paper's values, and against the program."""

import inspect
import json
import math
import pickle

import numpy as np
import pytest

import arclength
from arclength import _native
from arclength.kingpin import Wheel


def test_a_wheel_is_a_value():
    wheel = Wheel(l=0.08, r=1.0, v=4.0, k=100)
    assert wheel == Wheel() == pickle.loads(pickle.dumps(wheel))
    assert hash(wheel) == hash(Wheel())
    assert (wheel.l, wheel.k, wheel.k_u, wheel.tyre) == (0.08, 100.0, 100.0, "rigid")
    faster = wheel.replace(v=5)
    assert (faster.v, wheel.v) == (5.0, 4.0)
    assert faster != wheel
    assert Wheel(k_u=50).replace(k=80) == Wheel(k=80)
    assert Wheel(k=80).replace(k_u=50).k_u == 50.0
    assert Wheel(r=math.inf).r == math.inf
    with pytest.raises(AttributeError, match="replace"):
        wheel.v = 5
    with pytest.raises(AttributeError, match="has no `w`"):
        wheel.w
    assert {wheel: 1}[Wheel()] == 1


def test_a_wrong_parameter_is_told():
    with pytest.raises(arclength.InvalidInput) as refused:
        Wheel(l=-1)
    assert (refused.value.key, refused.value.value) == ("l", "-1")
    assert refused.value.allowed == "1e-6 to 1000"
    with pytest.raises(arclength.InvalidInput, match="unknown key") as refused:
        Wheel(lenght=1)
    assert refused.value.key == "lenght"
    with pytest.raises(ValueError, match="not a number"):
        Wheel(l=math.nan)
    with pytest.raises(arclength.InvalidInput, match="tyre"):
        Wheel(tyre="square")


def test_the_table_of_parameters():
    speed = Wheel.parameters["v"]
    assert (speed.unit, speed.default, speed.infinite) == ("m/s", 4.0, False)
    assert "towing speed" in repr(Wheel.parameters)
    assert set(Wheel().as_dict()) <= {*Wheel.parameters, "tyre"}


def test_files_of_wheels(tmp_path, program):
    wheel = Wheel(l=0.1, r=math.inf, k_q=200)
    wheel.save(tmp_path / "wheel.toml")
    assert Wheel.from_file(tmp_path / "wheel.toml") == wheel
    done = program("kingpin", "stability", "--wheel", "wheel.toml", "--format", "json", "-q")
    assert json.loads(done.stdout)["growth_rate"] == wheel.stability().growth_rate
    (tmp_path / "wrong.toml").write_text("l = 2000\n")
    with pytest.raises(arclength.InvalidInput, match="line 1") as refused:
        Wheel.from_file(tmp_path / "wrong.toml")
    assert refused.value.key == "l"


def test_uniform_motion_and_stability():
    wheel = Wheel()
    steady = wheel.steady()
    assert steady.psi == pytest.approx(0.07935648, abs=1e-8)
    assert steady.rolls is False
    # On a circle of radius r the wheel's speed over the caster's yaw rate is geometry: V^2 = (r^2 - l^2 ..)v^2; V from theory.
    along = wheel.steady(along=("v", 1, 4, 3))
    np.testing.assert_array_equal(along.columns["v"], [1, 2.5, 4])
    assert along[2].psi == steady.psi
    stability = wheel.stability()
    assert stability.critical_speed == pytest.approx(8.431037, abs=1e-6)
    assert stability.eigenvalues.dtype == complex
    assert stability.eigenvalues.real.max() == pytest.approx(stability.growth_rate)
    assert stability.stable is True


def test_hopf_point_cycles_and_locus():
    wheel = Wheel()
    hopf = wheel.hopf(along=("v", 1, 12))
    assert hopf["HB1"].value == pytest.approx(wheel.stability().critical_speed, rel=1e-12)
    assert hopf["HB1"].normal_form.criticality == "subcritical"
    cycles = hopf["HB1"].cycles(along=("v", 3.5, 9), at=4)
    # The paper's cycle at 4 m/s, as the README of the program has it.
    assert cycles["AT1"].period == pytest.approx(0.15274193, abs=1e-8)
    assert cycles["AT1"].psi_max == pytest.approx(0.63516456, abs=1e-8)
    assert cycles["AT1"].stable is False
    curve = wheel.locus(("v", 8, 9), ("c_q", 0, 0.01))
    assert len(curve) > 2
    assert curve.columns["c_q"].max() <= 0.01


def test_results_are_those_of_the_program(program, tmp_path):
    done = program("kingpin", "hopf", "--along", "v=1:12", "-o", "hopf.json", "-q")
    assert done.returncode == 0, done.stderr
    hopf = Wheel().hopf(along=("v", 1, 12))
    assert hopf.to_json() == (tmp_path / "hopf.json").read_bytes()
    again = arclength.load(tmp_path / "hopf.json")
    assert again["HB1"].cycles(along=("v", 8, 9)).labels[0] == "HB1"
    program("kingpin", "chart", "--x", "v=1:10:7", "--y", "l=0.05:0.1:5", "-o", "chart.csv", "-q")
    chart = Wheel().chart(("v", 1, 10, 7), ("l", 0.05, 0.1, 5))
    chart.save(tmp_path / "own.csv")
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "chart.csv").read_bytes()


def test_a_chart_is_a_plane():
    chart = Wheel().chart(("v", 1, 10, 7), ("l", 0.05, 0.1, 5))
    assert chart.growth_rate.shape == chart.stable.shape == chart.rolls.shape == (5, 7)
    one = Wheel(v=10, l=0.1).stability().growth_rate
    assert chart.growth_rate[4, 6] == pytest.approx(one, rel=1e-10)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    assert chart.plot().get_xlabel() == "v (m/s)"
    matplotlib.pyplot.close("all")


def test_motions_and_where_they_end():
    wheel = Wheel(v=6)
    motion = wheel.simulate(0.5, perturb={"psi": 0.1}, points=6)
    assert motion["psi"].shape == (6,)
    assert motion["psi"][0] == pytest.approx(wheel.steady().psi + 0.1)
    assert motion.columns.units["psi"] == "rad"
    with pytest.warns(arclength.AnalysisWarning, match="static friction"):
        basin = wheel.basin(("psi", -1, 1, 3), ("Omega", -60, 60, 3))
    assert len(basin.fates) == 9
    assert basin.fractions[0].fate == "uniform motion"


def test_dampers():
    damper = Wheel(r=math.inf, l=0.04).damper(up_to=3, small_motions=True)
    assert damper.c_q == pytest.approx(0.068781957, rel=1e-7)
    assert damper.c_psi == pytest.approx(3.6264e-4, rel=1e-4)
    # On circles it takes more, most on the tightest.
    over = Wheel(l=0.04).damper(up_to=3, radius=(0.9, math.inf), small_motions=True)
    assert over.c_q > damper.c_q and over.corner["c_q_at"]["r"] == pytest.approx(0.9)
    assert Wheel(l=0.04).damper(up_to=3, radius=[math.inf], small_motions=True).c_q == pytest.approx(damper.c_q)
    with pytest.raises(arclength.InvalidInput, match="radius"):
        Wheel().damper(up_to=3, radius=(1.0, 2.0, 3.0))


def test_parameters_from_a_record():
    wheel = Wheel(r=math.inf, v=1, l=0.1, c_psi=0.002, k=150)
    motion = wheel.simulate(1.0, perturb={"psi": 0.2}, points=201)
    record = {"t": motion["t"], "psi": motion["psi"]}
    fit = wheel.replace(k=100, c_psi=0.001).fit((record, {"v": 1}), estimate=["k", "c_psi"], blow=False)
    estimates = {entry.key: entry.value for entry in fit.estimates}
    assert estimates["k"] == pytest.approx(150, rel=1e-3)
    assert estimates["c_psi"] == pytest.approx(0.002, rel=1e-2)
    assert fit.wheel.k == estimates["k"]


#: Methods with what a request of the analysis takes at least.
METHODS = [
    (Wheel.chart, "kingpin.chart", {}),
    (Wheel.hopf, "kingpin.hopf", {"along": {"key": "v", "start": 1, "end": 2}}),
    (Wheel.cycles, "kingpin.cycles", {"along": {"key": "v", "start": 1, "end": 2}}),
    (Wheel.shimmy, "kingpin.shimmy", {"along": {"key": "v", "start": 1, "end": 2}}),
    (Wheel.simulate, "kingpin.simulate", {"duration": 1.0}),
    (Wheel.basin, "kingpin.basin", {}),
    (Wheel.safe_kick, "kingpin.safe-kick", {}),
    (Wheel.margin, "kingpin.margin", {}),
    (Wheel.damper, "kingpin.damper", {"up_to": {"key": "v", "value": "1"}}),
    (arclength.Model.equilibria, "arclength.equilibria", {"model": {"source": {"file": "m"}}, "along": {"key": "a"}}),
    (arclength.models.ModelPoint.equilibria, "arclength.equilibria", {"model": {"source": {"file": "m"}}, "along": {"key": "a"}}),
    (arclength.models.ModelPoint.cycles, "arclength.cycles", {"from": {"path": "f", "label": "l"}, "along": {"key": "a"}}),
    (arclength.models._cycles, "arclength.cycles", {"from": {"path": "f", "label": "l"}, "along": {"key": "a"}}),
    (arclength.models._simulate, "arclength.simulate", {"model": {"source": {"file": "m"}}}),
    (arclength.Model.simulate, "arclength.simulate", {"model": {"source": {"file": "m"}}}),
    (arclength.models.ModelPoint.simulate, "arclength.simulate", {"model": {"source": {"file": "m"}}}),
    (arclength.Model.cycles, "arclength.cycles", {"from": {"path": "f", "label": "l"}, "along": {"key": "a"}}),
    (
        arclength.models.ModelPoint.locus,
        "arclength.locus",
        {"from": {"path": "f", "label": "l"}, "in": [{"key": "a", "start": 0, "end": 1}, {"key": "b", "start": 0, "end": 1}]},
    ),
    (arclength.kingpin.WheelPoint.cycles, "kingpin.cycles", {"along": {"key": "v", "start": 1, "end": 2}}),
    (
        arclength.kingpin.WheelPoint.locus,
        "kingpin.locus",
        {"from": {"path": "f", "label": "l"}, "in": [{"key": "a", "start": 0, "end": 1}, {"key": "b", "start": 0, "end": 1}]},
    ),
]


@pytest.mark.parametrize(("method", "analysis", "request_"), METHODS)
def test_defaults_are_those_of_the_requests(method, analysis, request_):
    complete = json.loads(_native.complete_request(analysis, json.dumps(request_)))
    own = {"monitors", "until", "set", "start", "overlay", "perturb", "threads", "progress", "samples", "section", "direction", "blow"}
    compared = 0
    for name, parameter in inspect.signature(method).parameters.items():
        if parameter.default is inspect.Parameter.empty or (name in own and name not in complete):
            continue
        default = parameter.default
        if isinstance(default, tuple) and len(default) == 4:
            default = dict(zip(("key", "start", "end", "count"), default, strict=True))
        expected = complete.get(name)
        if name in ("monitors", "set", "start", "overlay", "perturb"):
            assert not default and not expected
            continue
        assert (list(default) if default == () else default) == expected, name
        compared += 1
    assert compared > 0
