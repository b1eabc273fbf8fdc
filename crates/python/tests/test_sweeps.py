"""Sweeps: the same bytes whoever works on them, nothing lost and nothing twice, whatever dies in the middle."""

import concurrent.futures
import functools
import hashlib
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import arclength
from arclength.__main__ import main
from arclength.kingpin import Wheel
from arclength.sweeps import Listed

pytest.importorskip("pyarrow")
import pyarrow.parquet  # noqa: E402


def circle(x, y, radius=1.0):
    return {"distance": x * x + y * y, "inside": x * x + y * y < radius, "name": f"{x:g}"}


GRID = arclength.grid(x=(-1, 1, 11), y=[0.0, 0.25, 0.5])


def files(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in Path(folder).iterdir()}


def test_a_grid_in_its_order(tmp_path):
    swept = arclength.sweep(circle, GRID, tmp_path, chunk=4)
    table = swept.to_pandas()
    assert len(table) == len(swept) == len(GRID) == 33
    x, y = (values.ravel() for values in np.meshgrid(np.linspace(-1, 1, 11), [0, 0.25, 0.5], indexing="ij"))
    np.testing.assert_array_equal(table["x"], x)
    np.testing.assert_array_equal(table["y"], y)
    np.testing.assert_array_equal(table["distance"], x * x + y * y)
    assert table["inside"].dtype == bool
    assert table["problem"].isna().all()
    manifest = swept.manifest
    assert [entry["rows"] for entry in manifest["chunks"]] == [4] * 8 + [1]
    for path, entry in zip(swept.files, manifest["chunks"], strict=True):
        assert hashlib.sha256(path.read_bytes()).hexdigest() == entry["sha256"]
    swept.write(tmp_path / "all.parquet")
    assert pyarrow.parquet.read_table(tmp_path / "all.parquet").equals(swept.to_arrow())


@pytest.mark.parametrize("start", [0, 1, 2, 3, 4, 5, 97])
def test_a_random_point_depends_on_its_number_only(start):
    sample = arclength.random_sample(100, seed=7, v=(1, 8), l=(0.02, 0.3))
    whole = sample.points(0, 100)
    part = sample.points(start, 100)
    for name, (low, high) in {"v": (1, 8), "l": (0.02, 0.3)}.items():
        np.testing.assert_array_equal(part[name], whole[name][start:])
        assert ((whole[name] >= low) & (whole[name] < high)).all()
    assert len({*whole["v"]}) == 100
    longer = arclength.random_sample(1_000, seed=7, v=(1, 8))
    np.testing.assert_array_equal(longer.points(0, 100)["v"], whole["v"])
    # Uniform: the mean of 100,000 within five of its standard deviations.
    mean = arclength.random_sample(100_000, seed=3, x=(0, 1)).points(0, 100_000)["x"].mean()
    assert abs(mean - 0.5) < 5 / np.sqrt(12 * 100_000)


def test_it_goes_on_where_it_was(tmp_path):
    asked = []

    def counted(x):
        asked.append(x)
        return {"square": x * x}

    sample = arclength.grid(x=(0, 9, 10))
    keywords = {"fields": {"square": float}, "chunk": 2, "threads": 1}
    swept = arclength.sweep(counted, sample, tmp_path, **keywords)
    before = files(tmp_path)
    tried = len(asked)
    swept.files[1].unlink()
    whole = swept.files[3].read_bytes()
    swept.files[3].write_bytes(whole[: len(whole) // 2])
    (tmp_path / ".dead.part").write_bytes(b"half")
    asked.clear()
    arclength.sweep(counted, sample, tmp_path, **keywords)
    assert sorted(asked) == [2, 3, 6, 7], "what is missing or torn is computed again, and nothing else"
    (tmp_path / ".dead.part").unlink()
    assert files(tmp_path) == before
    assert tried >= 10


def test_another_sweep_is_refused(tmp_path):
    arclength.sweep(circle, GRID, tmp_path, chunk=16)
    for changed in ({"sample": arclength.grid(x=(-1, 1, 12), y=[0.0])}, {"constants": {"radius": 2.0}}, {"version": "2"}, {"chunk": 8}):
        with pytest.raises(arclength.InvalidInput):
            arclength.sweep(**{"function": circle, "sample": GRID, "folder": tmp_path, **changed})
    assert arclength.sweep(circle, GRID, tmp_path).chunk == 16, "the size stands in the folder"


def test_what_goes_wrong_is_told(tmp_path):
    def fails(x):
        if x == 3:
            raise arclength.ComputationFailed("no orbit")
        return {"square": x * x}

    table = arclength.sweep(fails, {"x": [1, 2, 3]}, tmp_path / "a").to_pandas()
    assert table["problem"].tolist()[2] == "no orbit"
    assert table["square"].isna().tolist() == [False, False, True]

    def wrong(x):
        return {"ratio": 1 / (x - 2)}

    with pytest.raises(ZeroDivisionError) as error:
        arclength.sweep(wrong, {"x": [1.0, 3.0, 2.0]}, tmp_path / "b", fields={"ratio": float}, chunk=1)
    assert any("x = 2" in note for note in error.value.__notes__)
    with pytest.raises(arclength.InvalidInput, match="first points"):
        arclength.sweep(lambda x: {"a": "word" if x > 3 else 1.0}, {"x": list(range(100))}, tmp_path / "c", fields={"a": float}, chunk=10)
    with pytest.raises(arclength.InvalidInput, match="not a function"):
        arclength.sweep(3, GRID, tmp_path / "d")
    with pytest.raises(arclength.InvalidInput, match="not an axis"):
        arclength.grid(x=(0, 1))
    with pytest.raises(arclength.InvalidInput, match="differ in length"):
        Listed({"x": [1], "y": [1, 2]})
    with pytest.raises(arclength.InvalidInput, match="i/n"):
        arclength.sweep(circle, GRID, tmp_path / "e", shard="3/2")


def test_analyses_of_wheels_and_models(tmp_path, lure):
    wheel = Wheel(r=2)
    sample = arclength.grid(v=(1, 8, 3), l=[0.08, 0.1])
    table = arclength.sweep(wheel.stability, sample, tmp_path / "a", fields=["growth_rate", "stable", "eigenvalues.0.1"]).to_pandas()
    one = wheel.replace(v=4.5, l=0.1).stability()
    assert table["growth_rate"][3] == one.growth_rate
    assert table["eigenvalues.0.1"][3] == one.eigenvalues[0].imag
    # All at once gives the same numbers.
    at_once = arclength.sweep(wheel.stability_at, sample, tmp_path / "b").to_pandas()
    np.testing.assert_array_equal(at_once["growth_rate"], table["growth_rate"])
    np.testing.assert_array_equal(at_once["stable"], table["stable"])
    model = arclength.Model.from_ode(lure)
    motion = arclength.sweep(
        model.simulate, {"alpha": [1.5, 2.0]}, tmp_path / "c", constants={"duration": 1.0, "start": {"x": 0.1}}, fields=["states.x.0", "states.x.-1"]
    ).to_pandas()
    assert motion["states.x.0"].tolist() == [0.1, 0.1]
    assert motion["states.x.-1"][1] == model.simulate(1.0, start={"x": 0.1})["x"][-1]
    with pytest.raises(arclength.InvalidInput, match="growth_rate"):
        arclength.sweep(wheel.stability, sample, tmp_path / "d", fields=["growth"])


def test_stability_at_points_is_that_of_a_chart():
    chart = Wheel().chart(("v", 0.5, 12, 40), ("l", 0.02, 0.3, 30))
    v, l = np.meshgrid(chart.x["values"], chart.y["values"])
    at = Wheel().stability_at({"v": v.ravel(), "l": l.ravel()}, threads=2)
    np.testing.assert_array_equal(at["growth_rate"], chart.growth_rate.ravel())
    np.testing.assert_array_equal(at["rolls"], chart.rolls.ravel().astype(bool))
    decided = np.array([stable is not None for stable in chart.stable.ravel()])
    np.testing.assert_array_equal(np.ma.getmaskarray(at["stable"]), ~decided)
    np.testing.assert_array_equal(at["stable"][decided].astype(bool), chart.stable.ravel()[decided].astype(bool))
    with pytest.raises(arclength.InvalidInput, match="unknown key"):
        Wheel().stability_at({"w": np.ones(3)})
    with pytest.raises(arclength.InvalidInput, match="equal length"):
        Wheel().stability_at({"v": np.ones(3), "l": np.ones(2)})


STUDY = """
import arclength

def slow(x):
    total = 0.0
    for index in range(20_000):
        total += (x + index) ** -2.0
    return {"total": total}

study = dict(function=slow, sample=arclength.grid(x=(1, 2, 400)), folder="out", chunk=8, threads=1)
"""


def command(folder, *arguments):
    return subprocess.Popen(
        [sys.executable, "-m", "arclength", *arguments], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def test_shards_killed_in_the_middle(tmp_path, monkeypatch, capsys):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    for folder in (whole, parts):
        folder.mkdir()
        (folder / "study.py").write_text(STUDY)
    monkeypatch.chdir(whole)
    assert main(["sweep", "study.py", "-q"]) == 0
    shards = [command(parts, "sweep", "study.py", "-q", "--shard", f"{index}/2") for index in (1, 2)]
    deadline = time.monotonic() + 60
    while len(list((parts / "out").glob("*.parquet"))) < 6 and time.monotonic() < deadline:
        time.sleep(0.01)
    for shard in shards:
        shard.kill()
        shard.wait()
    there = {path.name for path in (parts / "out").glob("*.parquet")}
    assert 0 < len(there) < 50
    monkeypatch.chdir(parts)
    assert main(["merge", "out"]) == 1
    assert "chunks are not there" in capsys.readouterr().err
    for index in (1, 2):
        assert main(["sweep", "study.py", "--shard", f"{index}/2"]) == 0
    assert "100.0 %" in capsys.readouterr().err
    assert main(["merge", "out", "-o", "out.parquet"]) == 0
    mine = {name: content for name, content in files(parts / "out").items() if not name.endswith(".part")}
    assert mine == files(whole / "out"), "nothing lost, nothing twice, the same bytes"
    assert len(pyarrow.parquet.read_table(parts / "out.parquet")) == 400


def test_a_script_without_a_study(tmp_path, capsys):
    (tmp_path / "empty.py").write_text("x = 1\n")
    for script in ("empty.py", "missing.py"):
        assert main(["sweep", str(tmp_path / script)]) == 2
        assert "error: " in capsys.readouterr().err


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="not on this system")
def test_a_process_killed_in_the_middle(tmp_path):
    context = multiprocessing.get_context("spawn")
    keywords = {"chunk": 3, "constants": {"marker": str(tmp_path / "killed")}, "fields": {"square": float}}
    sample = arclength.grid(x=(0, 29, 30))
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        with pytest.raises(concurrent.futures.process.BrokenProcessPool):
            arclength.sweep(dies_once, sample, tmp_path / "a", client=pool, **keywords)
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        arclength.sweep(dies_once, sample, tmp_path / "a", client=pool, **keywords)
    arclength.sweep(dies_once, sample, tmp_path / "b", **keywords)
    left = {name: content for name, content in files(tmp_path / "a").items() if not name.endswith(".part")}
    assert left == files(tmp_path / "b")


def dies_once(x, marker):
    if x == 20 and multiprocessing.parent_process() is not None and not os.path.exists(marker):
        Path(marker).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"square": x * x}


def test_workers_of_dask_killed_in_the_middle(tmp_path):
    distributed = pytest.importorskip("distributed")
    script = textwrap.dedent("""
        import multiprocessing, os, signal
        from pathlib import Path
        import arclength

        def dies(x, marker):
            path = Path(f"{marker}{int(x) // 20}")
            if x in (25, 45) and multiprocessing.parent_process() is not None and not path.exists():
                path.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return {"square": x * x}

        if __name__ == "__main__":
            from distributed import Client, LocalCluster
            with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster, Client(cluster) as client:
                arclength.sweep(dies, arclength.grid(x=(0, 59, 60)), "dask", chunk=3, client=client,
                                constants={"marker": os.path.abspath("killed")}, fields={"square": float})
            arclength.sweep(dies, arclength.grid(x=(0, 59, 60)), "here", chunk=3,
                            constants={"marker": os.path.abspath("killed")}, fields={"square": float})
    """)
    assert distributed
    (tmp_path / "run.py").write_text(script)
    done = subprocess.run([sys.executable, "run.py"], cwd=tmp_path, capture_output=True, text=True, timeout=180)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in tmp_path.glob("killed*")} == {"killed1", "killed2"}, "two workers were killed"
    there = {name: content for name, content in files(tmp_path / "dask").items() if not name.endswith(".part")}
    assert there == files(tmp_path / "here")
    manifest = json.loads((tmp_path / "dask" / "manifest.json").read_text())
    assert [entry["chunk"] for entry in manifest["chunks"]] == list(range(20))


def test_progress_and_ctrl_c(tmp_path):
    told = []
    arclength.sweep(circle, GRID, tmp_path / "a", chunk=4, progress=lambda part, place: told.append(part))
    assert told == sorted(told)
    assert told[-1] == 1
    code = textwrap.dedent("""
        import signal, threading, time
        from pathlib import Path
        import arclength
        from arclength.kingpin import Wheel
        def interrupt():
            while not Path("out/sweep.json").exists():
                time.sleep(0.01)
            time.sleep(0.3)
            signal.raise_signal(signal.SIGINT)
        threading.Thread(target=interrupt, daemon=True).start()
        try:
            arclength.sweep(Wheel(v=6).safe_kick, arclength.grid(l=(0.05, 0.1, 100_000)), "out", chunk=1, fields={"returns": float})
        except arclength.Interrupted as interrupted:
            print(interrupted)
    """)
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert "the same call goes on" in done.stdout, done.stderr


SCALE = 2.0


def scaled(v):
    return {"y": SCALE * v}


def through_another(v):
    return scaled(v)


class Scales:
    def __init__(self, factor):
        self.factor = factor

    def __call__(self, v):
        return {"y": self.factor * v}


def closes(k):
    return lambda v: {"y": k * v}


def defaults(k):
    def inside(v, *, k=k):
        return {"y": k * v}

    return inside


def total(v, A):
    return {"y": float(np.sum(A)) * v}


LARGE = np.arange(3000.0)
CHANGED = LARGE.copy()
CHANGED[1500] = -1e9
PAIR = [lambda v: {"y": v}, lambda v: {"y": -v}]


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"function": closes(1.0)}, {"function": closes(100.0)}),
        ({"function": defaults(1.0)}, {"function": defaults(100.0)}),
        ({"function": PAIR[0]}, {"function": PAIR[1]}),
        ({"function": Scales(1.0)}, {"function": Scales(2.0)}),
        ({"function": functools.partial(total, A=LARGE)}, {"function": functools.partial(total, A=CHANGED)}),
        ({"function": total, "constants": {"A": LARGE}}, {"function": total, "constants": {"A": CHANGED}}),
        ({"function": total, "constants": {"A": np.array([1.0])}}, {"function": total, "constants": {"A": np.array([1.000000001])}}),
        ({"function": total, "constants": {"A": [LARGE]}}, {"function": total, "constants": {"A": [CHANGED]}}),
        ({"function": total, "constants": {"A": (1, 2)}}, {"function": total, "constants": {"A": (1, 3)}}),
        ({"function": scaled, "sample": {"v": np.zeros(1)}}, {"function": scaled, "sample": {"v": np.zeros(1, int)}}),
    ],
)
def test_what_a_function_depends_on_tells_it_from_others(tmp_path, first, second):
    first, second = ({"sample": {"v": [1.0]}, "fields": {"y": float}, "chunk": 1, **one} for one in (first, second))
    arclength.sweep(**first, folder=tmp_path)
    arclength.sweep(**first, folder=tmp_path)
    with pytest.raises(arclength.InvalidInput, match="another sweep is in there"):
        arclength.sweep(**second, folder=tmp_path)


def test_what_is_called_and_global_values_tell_a_function_from_others(tmp_path, monkeypatch):
    sample = {"v": [1.0]}
    arclength.sweep(through_another, sample, tmp_path / "a")
    arclength.sweep(scaled, sample, tmp_path / "b")
    monkeypatch.setitem(globals(), "SCALE", 3.0)
    with pytest.raises(arclength.InvalidInput, match="function global scaled differs"):
        arclength.sweep(through_another, sample, tmp_path / "a")
    with pytest.raises(arclength.InvalidInput, match="function global SCALE differs"):
        arclength.sweep(scaled, sample, tmp_path / "b")


def test_a_module_of_ones_own_tells_a_function_from_others(tmp_path):
    script = textwrap.dedent("""
        import arclength, own
        def f(v):
            return {"y": own.times(v), "unused": 0.0}
        print(arclength.sweep(f, {"v": [1.0]}, "out").to_pandas().y[0])
    """)
    outputs = []
    for seed, text in (("1", "def times(v): return 2 * v\n"), ("2", "# the same\ndef times(v): return 2 * v\n"), ("3", "def times(v): return 3 * v\n")):
        (tmp_path / "own.py").write_text(text)
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])}
        command = [sys.executable, "-B", "-c", script]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60)
        outputs.append(done.stdout or done.stderr)
    assert outputs[:2] == ["2.0\n", "2.0\n"], "the same in every process, and whatever a remark says"
    assert "global own.times differs" in outputs[2]


def test_a_value_of_which_nothing_can_be_told_is_refused(tmp_path):
    lock = threading.Lock()

    def locked(v):
        with lock:
            return {"y": v}

    with pytest.raises(arclength.InvalidInput, match="closure lock: of a lock in it cannot be told") as refused:
        arclength.sweep(locked, {"v": [1.0]}, tmp_path)
    assert refused.value.key == "closure lock"
    assert 'version="' in refused.value.allowed
    assert arclength.sweep(locked, {"v": [1.0]}, tmp_path, version="1").to_pandas().y[0] == 1
    with pytest.raises(arclength.InvalidInput, match="another sweep"):
        arclength.sweep(locked, {"v": [1.0]}, tmp_path, version="2")


def words(v):
    return {"s": "abcdefgh" * 3 + str(v)}


def test_a_damaged_chunk_is_computed_again(tmp_path):
    sample = arclength.grid(v=(0, 1, 100))
    swept = arclength.sweep(words, sample, tmp_path, chunk=30)
    whole, manifest = swept.files[0].read_bytes(), swept.manifest
    table = swept.to_arrow()
    for place in (4, 40, 200, len(whole) // 2, len(whole) - 5):
        damaged = bytearray(whole)
        damaged[place] ^= 1
        swept.files[0].write_bytes(damaged)
        with pytest.raises(arclength.ComputationFailed, match="not what the manifest says"):
            swept.to_arrow()
        with pytest.raises(arclength.ComputationFailed, match="damaged: 0;"):
            arclength.merge(tmp_path)
        assert swept.manifest == manifest
        again = arclength.sweep(words, sample, tmp_path, chunk=30)
        assert (again.files[0].read_bytes(), again.manifest) == (whole, manifest)
        assert again.to_arrow().equals(table)
    # Whatever happens to its hash, the chunk is right.
    beside = swept.files[0].with_suffix(".sha256")
    assert beside.read_text() == f"{hashlib.sha256(whole).hexdigest()}  {swept.files[0].name}\n"
    beside.write_text("0" * 64)
    assert arclength.sweep(words, sample, tmp_path, chunk=30).manifest == manifest
    beside.unlink()
    assert arclength.sweep(words, sample, tmp_path, chunk=30).manifest == manifest


def test_other_types_of_columns_are_refused(tmp_path):
    arclength.sweep(scaled, {"v": [1.0]}, tmp_path, fields={"y": float})
    with pytest.raises(arclength.InvalidInput, match="field y of word: the sweep .* was begun with number"):
        arclength.sweep(scaled, {"v": [1.0]}, tmp_path, fields={"y": str})
    arclength.sweep(scaled, {"v": [1.0]}, tmp_path, fields=["y"])


def test_a_damaged_plan_is_refused(tmp_path):
    arclength.sweep(words, arclength.grid(v=(0, 1, 100)), tmp_path, chunk=30)
    plan = tmp_path / "sweep.json"
    plan.write_text(plan.read_text().replace('"chunk":30', '"chunk":31'))
    with pytest.raises(arclength.InvalidInput, match="not what was written"):
        arclength.sweep(words, arclength.grid(v=(0, 1, 100)), tmp_path)


def test_an_unknown_keyword_of_an_analysis(tmp_path):
    with pytest.raises(arclength.InvalidInput, match="w: neither a parameter nor a keyword of stability") as refused:
        arclength.sweep(Wheel().stability, {"w": [1.0]}, tmp_path)
    assert refused.value.key == "w"
    assert "c_q" in refused.value.allowed
    with pytest.raises(arclength.InvalidInput, match="duration"):
        arclength.sweep(Wheel().simulate, {"v": [1.0]}, tmp_path)


def test_chunks_of_the_programs_have_the_same_format(tmp_path, program):
    chart = ("chart", "--x", "v=1:9:12", "--y", "l=0.05:0.2:10", "-q")
    assert program("kingpin", *chart, "-o", "whole.parquet").returncode == 0
    assert program("kingpin", *chart, "--shard", "2/2", "-o", "cells").returncode == 0
    with pytest.raises(arclength.ComputationFailed, match="4 of 8 chunks are not there, or damaged: 0, 2, 4, 6"):
        arclength.merge(tmp_path / "cells")
    assert program("kingpin", *chart, "--shard", "1/2", "-o", "cells").returncode == 0
    swept = arclength.merge(tmp_path / "cells", tmp_path / "merged.parquet")
    assert (len(swept), len(swept.files)) == (120, 8)
    whole = pyarrow.parquet.read_table(tmp_path / "whole.parquet").replace_schema_metadata(None)
    assert pyarrow.parquet.read_table(tmp_path / "merged.parquet").equals(whole)
    # The manifest of both is the same.
    manifest = (tmp_path / "cells" / "manifest.json").read_bytes()
    assert program("kingpin", "merge", "cells", "-q").returncode == 0
    assert (tmp_path / "cells" / "manifest.json").read_bytes() == manifest
    with pytest.raises(arclength.InvalidInput, match="another sweep is in there"):
        arclength.sweep(circle, GRID, tmp_path / "cells", chunk=4)
    # The other way round: what is said of a sweep.
    arclength.sweep(circle, GRID, tmp_path / "swept", chunk=4)
    refused = program("kingpin", "merge", "swept")
    assert refused.returncode == 2
    assert "python -m arclength merge" in refused.stderr
