"""A good citizen of Python: errors, Ctrl-C, threads, forks, standard output, import time, types."""

import concurrent.futures
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import arclength
from arclength.kingpin import Wheel

DECAY = "par k=1\nx'=-k*x\ninit x=1\ndone\n"


def test_one_hierarchy_with_what_was_wrong():
    model = arclength.Model.from_ode(DECAY)
    with pytest.raises(arclength.InvalidInput) as refused:
        model.equilibria(along=("kk", 0, 1))
    assert (refused.value.key, refused.value.value, refused.value.allowed) == ("along", "kk", "k")
    with pytest.raises(arclength.InvalidInput) as refused:
        model.equilibria(along=("k", 0.5, 2), steps=0)
    assert (refused.value.key, refused.value.value) == ("steps", "0")
    with pytest.raises(arclength.InvalidModel, match="line 1, column 7: unknown name `gama`"):
        arclength.Model.from_ode("x' = -gama*x\n")
    with pytest.raises(arclength.ComputationFailed):
        arclength.Model.from_ode("par a=1\nx'=a+x^2\ndone\n").equilibria(along=("a", 0.5, 2))
    branch = model.equilibria(along=("k", 0.5, 2))
    with pytest.raises(arclength.UnknownLabel, match="EP1") as missing:
        branch["HB1"]
    assert isinstance(missing.value, KeyError)
    for wrong in ("k=1:", ("k", 1), ("k", 1, 1), ("k", "a", 2), 3):
        with pytest.raises(arclength.InvalidInput):
            model.equilibria(along=wrong)
    with pytest.raises(arclength.InvalidInput, match="cannot be read"):
        arclength.Model.from_ode("no_such_file.ode")
    for kind in vars(arclength.errors).values():
        if isinstance(kind, type) and issubclass(kind, Exception) and not issubclass(kind, Warning):
            assert issubclass(kind, arclength.ArclengthError)


def test_nothing_is_printed(capfd):
    Wheel().hopf(along=("v", 1, 12))
    arclength.Model.from_ode(DECAY).simulate(1)
    assert capfd.readouterr() == ("", "")


LONG = """
import signal, sys, threading, time, traceback, warnings
import arclength
warnings.simplefilter("ignore")
from arclength.kingpin import Wheel
def interrupt():
    started.wait()
    time.sleep(float(sys.argv[1]))
    sent.append(time.perf_counter())
    signal.raise_signal(signal.SIGINT)
sent = []
started = threading.Event()
told = {"progress": lambda *_: started.set()}
fine = {"finer": 100000, "steps": 10000000}
branch = arclength.Model.from_ode("par a=-1\\nx'=y+a*x-x^3\\ny'=-x\\ndone\\n").equilibria(("a", -1, 1))
endless = arclength.Model.from_ode("x'=y\\ny'=-x\\ninit x=1\\n@ total=1e7\\ndone\\n")
run = {
    "chart": lambda: Wheel().chart(("v", 0.1, 12, 3000), ("l", 0.02, 0.3, 3000), **told),
    "basin": lambda: Wheel(v=6).basin(("psi", -1, 1, 300), ("Omega", -60, 60, 300), **told),
    "simulate": lambda: endless.simulate(points=10, **told),
    "cycles": lambda: branch["HB1"].cycles(("a", -1, 1), **fine, **told),
    "equilibria": lambda: branch.of_model.equilibria(("a", -1, 1), **fine, **told),
    "safe_kick": lambda: Wheel(v=6).safe_kick(**told),
    "damper": lambda: Wheel(r=float("inf"), l=0.04).damper(3, **told),
}[sys.argv[2]]
threading.Thread(target=interrupt, daemon=True).start()
try:
    result = run()
    print("result", result.interrupted, time.perf_counter() - sent[0])
except KeyboardInterrupt as error:
    traceback.print_exc()
    print("error", isinstance(error, arclength.Interrupted), time.perf_counter() - sent[0])
"""


@pytest.mark.parametrize(
    ("analysis", "kept"),
    [
        ("equilibria", True),
        ("cycles", True),
        ("simulate", True),
        ("chart", False),
        ("basin", False),
        ("safe_kick", False),
        ("damper", False),
    ],
)
def test_ctrl_c_stops_it_and_keeps_what_there_is(analysis, kept):
    done = subprocess.run([sys.executable, "-c", LONG, "0.2", analysis], capture_output=True, text=True, timeout=60)
    word, told, _ = done.stdout.split()
    assert (word, told) == (("result" if kept else "error"), "True"), done.stderr
    assert done.returncode == 0


WRITTEN = """
import os, signal, sys, threading, time
import arclength
from arclength.kingpin import Wheel
chart = Wheel().chart(("v", 0.1, 12, 500), ("l", 0.02, 0.3, 400))
def interrupt():
    # Once the file is begun.
    while not os.listdir():
        time.sleep(0.001)
    signal.raise_signal(signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    chart.save("chart.json")
    print("written")
except arclength.Interrupted as interrupted:
    print(interrupted)
"""


def test_ctrl_c_stops_the_writing_and_leaves_no_file(tmp_path):
    done = subprocess.run([sys.executable, "-c", WRITTEN], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert done.stdout == "interrupted before the result was written; no file was left behind\n", done.stderr
    assert list(tmp_path.iterdir()) == []


def test_progress_is_told_and_may_stop_it():
    told = []
    Wheel().chart(("v", 0.1, 12, 200), ("l", 0.02, 0.3, 150), progress=lambda part, place: told.append(part))
    assert told == sorted(told)
    assert all(0 <= part <= 1 for part in told)

    def stop(part, place):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        Wheel().chart(("v", 0.1, 12, 3000), ("l", 0.02, 0.3, 2000), progress=stop)


def test_the_interpreter_is_free_meanwhile():
    counted = []
    stop = threading.Event()

    def count():
        while not stop.is_set():
            counted.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    Wheel().chart(("v", 0.1, 12, 200), ("l", 0.02, 0.3, 150))
    stop.set()
    thread.join()
    assert len(counted) > 5


def test_threads_do_not_change_a_bit():
    first, second = (Wheel().chart(("v", 1, 10, 40), ("l", 0.05, 0.1, 30), threads=threads) for threads in (1, 3))
    assert first.to_json() == second.to_json()
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: Wheel().hopf(("v", 1, 12)).to_json(), range(8)))
    assert len(set(results)) == 1


def growth_rate(speed):
    return float(Wheel().chart(("v", speed, speed + 1, 2), ("l", 0.05, 0.1, 2)).growth_rate[0, 0])


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("not on this system")
    here = [growth_rate(speed) for speed in (1.0, 2.0, 3.0)]
    context = multiprocessing.get_context(method)
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        assert list(pool.map(growth_rate, (1.0, 2.0, 3.0))) == here


def test_memory_is_given_back():
    resource = pytest.importorskip("resource")
    model = arclength.Model.from_ode(DECAY)

    def largest():
        for _ in range(100):
            branch = model.equilibria(along=("k", 0.5, 2))
            _ = branch.columns["value"], branch.points, branch.to_json()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    largest()
    before = largest()
    assert largest() - before < 4000, "kilobytes"


def test_the_programs():
    names = {"arclength": ["equilibria", "cycles"], "kingpin": ["hopf", "report"]}
    for name, commands in names.items():
        path = os.path.join(os.path.dirname(sys.executable), name)
        done = subprocess.run([path, "--help"], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0
        assert all(command in done.stdout for command in commands)
        done = subprocess.run([path, "no-such-command"], capture_output=True, text=True, timeout=60)
        assert done.returncode == 2


def test_import_is_light():
    code = "import sys, arclength, arclength.kingpin; print([name for name in ('numpy', 'pandas', 'matplotlib', 'concurrent.futures') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "[]", done.stderr
    assert arclength.__version__


def test_everything_public_is_documented():
    for name in arclength.__all__:
        assert name.startswith("__") or getattr(arclength, name).__doc__, name


def test_types_as_editors_see_them():
    pytest.importorskip("pyright")
    project = os.path.join(os.path.dirname(os.path.dirname(__file__)), "pyproject.toml")
    command = [sys.executable, "-m", "pyright", "--project", project, "--pythonpath", sys.executable]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types():
    api = pytest.importorskip("mypy.api")
    folder = os.path.dirname(arclength.__file__)
    assert os.path.exists(os.path.join(folder, "py.typed"))
    text, errors, code = api.run(["--strict", "--ignore-missing-imports", "--follow-imports=silent", "-p", "arclength"])
    assert code == 0, text + errors
