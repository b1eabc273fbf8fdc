"""Results as objects: names of columns that differ, copies, equality, tables of other packages."""

import copy
import csv
import pickle
import warnings

import numpy as np
import pytest

import arclength
from arclength.kingpin import Wheel


@pytest.fixture(scope="module")
def hopf():
    """A Hopf point whose model has names of the result's own columns, and those that these would be changed to."""
    names = ["value", "label", "stable", "eigenvalue_1_real", "state_value"]

    def right(x, p):
        r = x[0] ** 2 + x[1] ** 2
        return [p.mu * x[0] - p.frequency * x[1] - x[0] * r, p.frequency * x[0] + p.mu * x[1] - x[1] * r, -x[2] + 1, -x[3] + 2, -x[4] + 3]

    model = arclength.Model(right, names, {"mu": -0.5, "frequency": 2.0, "first_lyapunov": 1.0})
    return model.equilibria(along=("mu", -1, 1))


STATES = ["state_state_value", "state_label", "state_stable", "state_eigenvalue_1_real", "state_value"]


def test_columns_of_a_branch_have_names_that_differ(hopf):
    columns = hopf.columns
    assert list(columns)[:8] == ["label", "value", "stable", *STATES]
    assert list(columns)[8] == "eigenvalue_1_real"
    assert len(set(columns)) == len(columns)
    np.testing.assert_array_equal(columns["value"], [point.value for point in hopf])
    assert list(columns["label"]) == [point.label for point in hopf]
    assert list(columns["stable"]) == [point.stable for point in hopf]
    for column, state in zip(STATES, ["value", "label", "stable", "eigenvalue_1_real", "state_value"], strict=True):
        np.testing.assert_array_equal(columns[column], [point.state[state] for point in hopf])
    np.testing.assert_array_equal(columns["eigenvalue_1_real"], [point.eigenvalues[0].real for point in hopf])


def test_tables_and_files_have_these_names(hopf, tmp_path):
    names = list(hopf.columns)
    pandas = pytest.importorskip("pandas")
    frame = hopf.to_pandas()
    assert list(frame.columns) == names
    hopf.save(tmp_path / "h.csv")
    assert next(csv.reader((tmp_path / "h.csv").read_text().splitlines())) == names
    again = pandas.read_csv(tmp_path / "h.csv")
    for table in (frame, again):
        np.testing.assert_array_equal(table["state_label"], hopf.columns["state_label"])
        np.testing.assert_array_equal(table["label"].isna(), [point.label is None for point in hopf])
    pyarrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet

    hopf.save(tmp_path / "h.parquet")
    for table in (hopf.to_arrow(), pyarrow.table(hopf), pyarrow.parquet.read_table(tmp_path / "h.parquet")):
        assert table.column_names == names
        np.testing.assert_array_equal(table["state_stable"], hopf.columns["state_stable"])
    dataset = pytest.importorskip("xarray") and hopf.to_xarray()
    assert list(dataset) == names
    polars = pytest.importorskip("polars")
    assert hopf.to_polars().columns == names
    assert hopf.to_polars()["state_value"].to_list() == hopf.columns["state_value"].tolist()
    assert polars.DataFrame(hopf).columns == names


def test_parameters_of_a_curve_have_names_that_differ(hopf):
    for name, start, end in (("frequency", 1, 3), ("first_lyapunov", 0, 2)):
        curve = hopf["HB1"].locus(("mu", -1, 1), (name, start, end))
        assert list(curve.columns)[:3] == ["label", "mu", f"parameter_{name}"]
        np.testing.assert_array_equal(curve.columns[f"parameter_{name}"], [point["values"][1] for point in curve])
        np.testing.assert_array_equal(curve.columns["frequency"], [point.frequency for point in curve])
        np.testing.assert_array_equal(curve.columns["value"], [point.state["value"] for point in curve])
    pytest.importorskip("matplotlib").use("Agg")
    assert curve.plot().get_ylabel() == "parameter_first_lyapunov"


def test_parameters_of_a_curve_of_cycles_have_names_that_differ():
    text = "par alpha=2, intervals=1\nx'=y\ny'=z\nz'=-alpha*z-intervals*y-x+x^2\ndone\n"
    cycles = arclength.Model.from_ode(text).equilibria(("alpha", -1.5, 1.5))["HB1"].cycles(("alpha", 0.5, 1.5))
    curve = cycles["PD1"].locus(("alpha", 0.5, 1), ("intervals", 0.8, 1.2))
    np.testing.assert_array_equal(curve.columns["parameter_intervals"], [point["values"][1] for point in curve])
    assert curve.columns["intervals"].dtype == np.uint64
    assert list(curve.columns["intervals"]) == [point.intervals for point in curve]


def test_auxiliary_quantities_have_names_that_differ():
    model = arclength.Model.from_ode("par a=1\nx'=a-x\naux value=2*x\ndone\n")
    branch = model.equilibria(("a", 0, 1))
    assert list(branch.columns)[:5] == ["label", "value", "stable", "x", "aux_value"]
    np.testing.assert_array_equal(branch.columns["aux_value"], 2 * branch.columns["x"])


def test_names_without_a_collision_stay():
    branch = arclength.Model(lambda x, p: [p.k - x[0]], ["v"], {"k": 1.0}).equilibria(("k", 0, 2))
    assert list(branch.columns) == "label value stable v eigenvalue_1_real eigenvalue_1_imaginary test_LP test_BP test_HB".split()


WHEEL_RESULTS = {
    "steady": lambda wheel: wheel.steady(),
    "steady along": lambda wheel: wheel.steady(along=("v", 1, 8, 3)),
    "stability": lambda wheel: wheel.stability(),
    "chart": lambda wheel: wheel.chart(("v", 1, 10, 5), ("l", 0.05, 0.1, 4)),
    "hopf": lambda wheel: wheel.hopf(("v", 1, 12)),
    "simulate": lambda wheel: wheel.simulate(0.1, points=5),
    "basin": lambda wheel: wheel.basin(("psi", -1, 1, 3), ("Omega", -60, 60, 3)),
    "safe kick": lambda wheel: wheel.safe_kick(duration=1.0),
    "margin": lambda wheel: wheel.margin(("v", 4, 5, 2), duration=1.0),
    "damper": lambda wheel: Wheel(r=float("inf"), l=0.04).damper(3, small_motions=True),
}


@pytest.mark.parametrize("name", WHEEL_RESULTS)
def test_results_of_wheels_are_pickled_and_copied(name, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = WHEEL_RESULTS[name](Wheel())
    for again in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result), pickle.loads(pickle.dumps(copy.copy(result)))):
        assert type(again) is type(result)
        assert (again.to_json(), again.warnings, again.interrupted) == (result.to_json(), result.warnings, result.interrupted)
        assert (repr(again), again.story, again._repr_svg_()) == (repr(result), result.story, result._repr_svg_())
        assert again.columns == result.columns
        assert again.columns.units == result.columns.units
        for ending in ("csv", "json", *(("svg",) if result._repr_svg_() else ())):
            paths = tmp_path / f"first.{ending}", tmp_path / f"second.{ending}"
            result.save(paths[0]), again.save(paths[1])
            assert paths[0].read_bytes() == paths[1].read_bytes()
        pytest.importorskip("pyarrow")
        assert again.to_arrow().equals(result.to_arrow())
    if name != "hopf":
        with pytest.raises(arclength.InvalidInput) as refused:
            again.save(tmp_path / "again.png")
        assert ".json, .csv" in refused.value.allowed


def test_equality_of_points(lure):
    branch = arclength.Model.from_ode(lure).equilibria(along=("alpha", -1.5, 1.5))
    point = branch["HB1"]
    again = pickle.loads(pickle.dumps(point))
    assert point == again
    assert not point != again
    assert point != branch["EP1"]
    assert point in branch
    assert again in branch
    assert "HB1" in branch
    assert "HB2" not in branch
    assert branch.columns == pickle.loads(pickle.dumps(branch)).columns
    assert branch.parameters == {"beta": 1.0}
    assert {"beta": 1.0} == branch.parameters


def test_errors_are_pickled_with_all_they_say():
    with pytest.raises(arclength.NotTraceable) as refused:
        arclength.Model(lambda x, p: [1.0 if x[0] > 0 else 2.0], ["x"])
    error = refused.value
    assert error.line and error.filename
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert vars(again) == vars(error)
    error.add_note("at x = 1")
    assert pickle.loads(pickle.dumps(error)).__notes__ == ["at x = 1"]


def test_the_end_of_a_motion_is_a_state():
    model = arclength.Model.from_ode("par a=1\nx'=y\ny'=-x+a*y*(1-x^2)\naux E=x^2+y^2\ninit x=1\n@ total=5\ndone\n")
    history = model.simulate()
    assert history.end.state == {"x": history["x"][-1], "y": history["y"][-1]}
    assert model.simulate(1, start=history.end.state)["x"][0] == history["x"][-1]
    assert list(history) == ["t", "x", "y", "E"]
    assert "x" in history
    assert 0 not in history
    assert list(Wheel().simulate(0.01, points=3))[0] == "t"


def test_datasets_are_saved(lure, tmp_path):
    pytest.importorskip("xarray")
    pytest.importorskip("netCDF4")
    branch = arclength.Model.from_ode(lure).equilibria(along=("alpha", -1.5, 1.5))
    dataset = branch.to_xarray()
    dataset.to_netcdf(tmp_path / "b.nc")
    undecided = [point.stable is None for point in branch]
    assert np.isnan(dataset.stable.values.astype(float)).tolist() == undecided
    chart = Wheel().chart(("v", 1, 10, 7), ("l", 0.05, 0.1, 5)).to_xarray()
    chart.to_netcdf(tmp_path / "c.nc")
    assert chart.rolls.dtype == bool
