"""Branches of models against closed forms, and against the programs."""

import json
import math
import pickle

import numpy as np
import pytest

import arclength
import arclength.kingpin

#: Where Lur'e's cycle doubles its period, and its period there: MatCont's and this engine's agree to all these digits.
DOUBLING = 0.6303020061596
PERIOD = 6.364071339441


@pytest.fixture
def equilibria(lure):
    return arclength.Model.from_ode(lure).equilibria(along=("alpha", -1.5, 1.5))


def test_hopf_point_with_its_normal_form(equilibria):
    hopf = equilibria["HB1"]
    assert equilibria.labels == ["EP1", "HB1", "EP2"]
    assert hopf.value == pytest.approx(1.0, abs=1e-14)
    assert hopf.normal_form.frequency == pytest.approx(1.0, abs=1e-14)
    assert hopf.normal_form.first_lyapunov == pytest.approx(-0.3, abs=1e-13)
    assert hopf.normal_form.criticality == "supercritical"
    assert hopf.eigenvalues.dtype == complex
    assert equilibria["EP1"].normal_form is None


def test_columns_are_the_points(equilibria):
    assert len(equilibria) == len(equilibria.points) == len(list(equilibria))
    assert equilibria.columns["value"].dtype == np.float64
    np.testing.assert_array_equal(equilibria.columns["value"], [point.value for point in equilibria])
    np.testing.assert_array_equal(equilibria.columns["x"], [point.state["x"] for point in equilibria])
    assert list(equilibria.columns["stable"]) == [point.stable for point in equilibria]
    assert equilibria[0] is equilibria.points[0]
    assert equilibria[-2:] == equilibria.points[-2:]
    assert equilibria.parameters == {"beta": 1.0}


def test_cycles_doublings_and_their_curve(equilibria):
    cycles = equilibria["HB1"].cycles(along=("alpha", -1.5, 1.5))
    doubling = cycles["PD1"]
    assert doubling.value == pytest.approx(DOUBLING, abs=1e-11)
    assert doubling.period == pytest.approx(PERIOD, abs=1e-10)
    doubled = doubling.cycles(along="alpha=-1.5:1.5")
    assert doubled["EP1"].period == pytest.approx(2 * PERIOD, rel=1e-3)
    curve = doubling.locus(("alpha", -2, 2), ("beta", 0.2, 2))
    assert "closed" in curve.ends[0].cause
    assert np.abs(curve.columns["alpha"] - DOUBLING).min() < 1e-10


def test_a_value_asked_for_and_monitors(lure):
    model = arclength.Model.from_ode(lure)
    branch = model.equilibria(along=("alpha", 0.5, 2), at=1.25, monitors={"alpha+beta": [2.75]})
    assert branch["AT1"].value == 1.25
    assert branch["AT1"].monitors["alpha+beta"] == 2.25
    assert any(abs(point.value - 1.75) < 1e-12 for point in branch if point.label)


def test_simulation_against_the_closed_form():
    model = arclength.Model.from_ode("par k=2\nx'=-k*x\ninit x=3\ndone\n")
    motion = model.simulate(1.5, points=16)
    np.testing.assert_allclose(motion["x"], 3 * np.exp(-2 * motion["t"]), rtol=1e-9)
    assert model([3.0]) == pytest.approx([-6.0])
    assert model([3.0], {"k": 0.5}) == pytest.approx([-1.5])
    other = model.simulate(1.0, set={"k": 0.0}, start={"x": 7.0})
    assert set(other["x"]) == {7.0}


def test_a_motion_that_has_settled_starts_a_branch_of_cycles():
    model = arclength.Model.from_ode("par mu=1\nx'=y\ny'=mu*(1-x^2)*y-x\ninit x=2\ndone\n")
    cycles = model.simulate(100).end.cycles(along=("mu", 0.5, 1.5), at=1)
    # The period of van der Pol's oscillator at mu = 1.
    assert cycles["AT1"].period == pytest.approx(6.663286859323, rel=1e-10)


def test_samples_start_a_branch_of_cycles():
    times = np.linspace(0, 2 * math.pi, 65)
    model = arclength.Model.from_ode("par mu=1\nx'=mu*x-y-x*(x^2+y^2)\ny'=x+mu*y-y*(x^2+y^2)\ndone\n")
    cycles = model.cycles({"t": times, "x": np.cos(times), "y": np.sin(times)}, along=("mu", 0.5, 2), at=[1.5])
    assert max(cycles["AT1"].max.values()) == pytest.approx(math.sqrt(1.5), rel=1e-9)


def test_a_section():
    model = arclength.Model.from_ode("x'=y\ny'=-x\ninit x=1\ndone\n")
    motion = model.simulate(20, section="x=0", direction="rising")
    np.testing.assert_allclose(motion["t"], 1.5 * math.pi + 2 * math.pi * np.arange(3), rtol=1e-9)


def test_results_are_the_bytes_of_the_program(program, tmp_path, lure, equilibria):
    (tmp_path / "lure.ode").write_text(lure)
    done = program("arclength", "equilibria", "lure.ode", "--along", "alpha=-1.5:1.5", "-o", "e.json", "-q")
    assert (done.returncode, done.stdout) == (0, "")
    model = arclength.Model.from_ode(tmp_path / "lure.ode")
    branch = model.equilibria(along=("alpha", -1.5, 1.5))
    assert branch.to_json() == (tmp_path / "e.json").read_bytes()
    done = program("arclength", "cycles", "--from", "e.json:HB1", "--along", "alpha=-1.5:1.5", "-o", "c.csv", "-o", "c.json", "-q")
    cycles = branch["HB1"].cycles(along=("alpha", -1.5, 1.5))
    assert cycles.to_json() == (tmp_path / "c.json").read_bytes()
    cycles.save(tmp_path / "own.csv")
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()


def test_files_go_both_ways(program, tmp_path, equilibria):
    equilibria.save(tmp_path / "own.json")
    done = program("arclength", "cycles", "--from", "own.json:HB1", "--along", "alpha=0.5:1.5", "-o", "c.json", "-q")
    assert done.returncode == 0, done.stderr
    cycles = arclength.Cycles.load(tmp_path / "c.json")
    assert isinstance(cycles, arclength.Cycles)
    assert cycles["PD1"].cycles(along=("alpha", 0.5, 1.5)).schema == "arclength.cycles"
    with pytest.raises(arclength.InvalidInput, match="not a Equilibria"):
        arclength.Equilibria.load(tmp_path / "c.json")
    (tmp_path / "no.json").write_text("{}")
    with pytest.raises(arclength.InvalidInput, match="not a result file"):
        arclength.load(tmp_path / "no.json")


def test_results_and_models_are_pickled(equilibria):
    again = pickle.loads(pickle.dumps(equilibria))
    assert again.to_json() == equilibria.to_json()
    point = pickle.loads(pickle.dumps(equilibria["HB1"]))
    assert point.cycles(along=("alpha", 0.9, 1.1)).labels[0] == "EP1"
    model = pickle.loads(pickle.dumps(equilibria.of_model))
    assert model.source == equilibria.of_model.source


def test_tables_of_others(equilibria):
    pandas = pytest.importorskip("pandas")
    frame = equilibria.to_pandas()
    assert list(frame.columns) == list(equilibria.columns)
    assert frame["stable"].dtype == "boolean"
    pyarrow = pytest.importorskip("pyarrow")
    table = equilibria.to_arrow()
    assert table.num_rows == len(equilibria)
    assert table.column("stable").type == pyarrow.bool_()
    assert table.column("stable").to_pylist() == [point.stable for point in equilibria]
    assert table.column("label").to_pylist() == [point.label for point in equilibria]
    np.testing.assert_array_equal(table.column("value").to_numpy(), equilibria.columns["value"])
    assert isinstance(frame, pandas.DataFrame)


def test_units_go_to_xarray():
    pytest.importorskip("xarray")
    chart = arclength.kingpin.Wheel().chart(("v", 1, 10, 7), ("l", 0.05, 0.1, 5)).to_xarray()
    assert chart.growth_rate.dims == ("l", "v")
    assert chart.growth_rate.attrs["units"] == "1/s"
    assert chart.v.attrs["units"] == "m/s"
    motion = arclength.kingpin.Wheel().simulate(0.1, points=5).to_xarray()
    assert (motion.psi.attrs["units"], motion.sizes["row"]) == ("rad", 5)


def test_a_stream_that_nobody_reads_is_freed(equilibria):
    for _ in range(1000):
        equilibria.__arrow_c_stream__()


def test_pictures(equilibria, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = equilibria.plot(y="x")
    assert axes.get_xlabel() == "alpha"
    assert {line.get_linestyle() for line in axes.lines} >= {"-", "--"}
    assert [text.get_text() for text in axes.texts] == ["HB1"]
    cycles = equilibria["HB1"].cycles(along=("alpha", 0.5, 1.5))
    assert cycles.plot(axes) is axes
    matplotlib.pyplot.close("all")
    assert equilibria._repr_svg_().startswith("<svg")
    assert "<pre>equilibria of" in equilibria._repr_html_()
    equilibria.save(tmp_path / "e.svg")
    with pytest.raises(arclength.InvalidInput, match="xyz"):
        equilibria.save(tmp_path / "e.xyz")


def test_the_file_is_the_document(equilibria):
    assert equilibria.document == json.loads(equilibria.to_json())
    assert equilibria.story.startswith("story of the run")
    assert equilibria.along.key == "alpha"
