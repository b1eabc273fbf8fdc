"""Bad arguments: errors of the package that say which, what was given and what is allowed; and types that see mistakes."""

import inspect
import json
import math
import re
import subprocess
import sys
import textwrap
from typing import get_args

import numpy as np
import pytest

import arclength
from arclength import _native, _requests
from arclength.kingpin import Wheel

DECAY = "par k=1\nx'=-k*x\ninit x=1\ndone\n"


@pytest.fixture(scope="module")
def model():
    return arclength.Model.from_ode(DECAY)


@pytest.fixture(scope="module")
def branch(model):
    return model.equilibria(along=("k", 0.5, 2))


WHOLE = "a whole number that is not negative and not too large"
BAD = [
    (lambda m, b: Wheel().simulate(1, threads=-1), "threads", "-1", "1 to 1024, or None for one for each processor"),
    (lambda m, b: Wheel().stability_at({"v": [1.0]}, threads=2**70), "threads", str(2**70), "1 to 1024, or None for one for each processor"),
    (lambda m, b: Wheel().hopf(("v", 1, 12), steps=-1), "steps", "-1", WHOLE),
    (lambda m, b: m.equilibria(("k", 0.5, 2), finer=-1), "finer", "-1", WHOLE),
    (lambda m, b: Wheel().basin(samples=2, seed=-1), "seed", "-1", WHOLE),
    (lambda m, b: Wheel().basin(samples=-1), "samples", "-1", WHOLE),
    (lambda m, b: Wheel().simulate(1, contact="ice"), "contact", "ice", "rolling, sliding"),
    (lambda m, b: Wheel().safe_kick(kind="push"), "kind", "push", "impulse, release-angle, jolt, step-steer"),
    (lambda m, b: m.simulate(1, method="magic"), "method", "magic", "auto, explicit, implicit"),
    (lambda m, b: m.simulate(1, direction="up"), "direction", "up", "both, rising, falling"),
    (lambda m, b: Wheel().simulate(math.inf), "duration", "inf", "a finite number"),
    (lambda m, b: Wheel().simulate(-1), "duration", "-1", "positive and finite, in s"),
    (lambda m, b: Wheel().safe_kick(largest=math.inf), "largest", "inf", "a finite number"),
    (lambda m, b: b["EP1"].cycles(("k", 0.5, 2), tolerance=math.inf), "tolerance", "inf", "a finite number"),
    (lambda m, b: m([[1.0]]), "state", "(1, 1)", "1 numbers, of shape (1,)"),
    (lambda m, b: m(["a"]), "state", "['a']", "1 numbers, of shape (1,)"),
    (lambda m, b: m.simulate(1, set=3), "set", "3", "a mapping from names to numbers"),
    (lambda m, b: b.columns[3], "column", "3", "label, value, stable, x, eigenvalue_1_real, eigenvalue_1_imaginary, test_LP, test_BP, test_HB"),
    (lambda m, b: b.save("x.txt"), "path", "x.txt", ".json, .csv, .parquet, .svg, .png, .pdf"),
    (lambda m, b: arclength.load("no_such_file"), "path", "no_such_file", None),
    (lambda m, b: arclength.Model(lambda x, p: [1, 2], ["x", "x"]), "states", "['x', 'x']", "names that differ"),
    (lambda m, b: arclength.Model(lambda x, p: [1], ["x"], {"X": 1}), "parameters", "X", None),
    (lambda m, b: arclength.Model(lambda x, p: [1], 3), "states", "3", "names, or a mapping from names to initial values"),
    (lambda m, b: arclength.Model.from_ode(3), "model", "3", "the text of a model, or the path of its file"),
    (lambda m, b: m.cycles({"t": ["a"]}, ("k", 1, 2)), "samples t", "'a'", "a number"),
    (lambda m, b: Wheel().stability_at({"v": ["a"]}), "points", None, "arrays of shape (n,), one for each key"),
    (lambda m, b: Wheel().simulate(1, perturb={"zz": 1}), "zz", "zz", "u, q, psi, V, Omega"),
]


@pytest.mark.parametrize(("call", "key", "value", "allowed"), BAD)
def test_a_bad_argument_is_told(model, branch, call, key, value, allowed):
    with pytest.raises(arclength.InvalidInput) as refused:
        call(model, branch)
    error = refused.value
    assert (error.key, error.value) == (key, value)
    assert allowed is None or error.allowed == allowed
    assert "request" not in str(error)


@pytest.mark.parametrize(
    ("words", "analysis", "request_"),
    [
        (_requests.Method, "arclength.simulate", {"model": {"source": {"file": "m"}}, "method": "?"}),
        (_requests.Contact, "kingpin.simulate", {"duration": 1.0, "contact": "?"}),
        (_requests.Kick, "kingpin.safe-kick", {"kind": "?"}),
        (
            _requests.Direction,
            "arclength.simulate",
            {"model": {"source": {"file": "m"}}, "section": {"expression": "x", "direction": "?"}},
        ),
    ],
)
def test_words_are_those_of_the_requests(words, analysis, request_):
    with pytest.raises(arclength.InvalidInput) as refused:
        _native.complete_request(analysis, json.dumps(request_))
    told = re.findall("`([^`]*)`", str(refused.value))
    assert told[1:] == list(get_args(words))


def test_keywords_are_spelt_out():
    for function in (
        *(value for value in vars(arclength.Model).values() if inspect.isfunction(value)),
        *(value for name, value in vars(Wheel).items() if inspect.isfunction(value) and name not in ("__init__", "replace")),
        arclength.models.ModelPoint.simulate,
        arclength.models.ModelPoint.cycles,
    ):
        kinds = {one.kind for one in inspect.signature(function).parameters.values()}
        assert inspect.Parameter.VAR_KEYWORD not in kinds, function


MISTAKES = """
import arclength
from arclength.kingpin import Wheel

m = arclength.Model(lambda x, p: [-x[0]], ["x"], {"a": 1.0})
m.simulate(1.0, methodd="auto")
m.simulate(1.0, method="magic")
m.simulate(1.0, points="many")
m.cycles({"t": [0]}, ("a", 0, 1), finner=2)
Wheel().simulate(1.0, contact="ice")
Wheel().safe_kick(kind="push")
Wheel().locus(("v", 1, 2), ("l", 1, 2), stepz=3)
m.equilibria(("a", 0, 1))["HB1"].cycles(along=5)
Wheel().hopf(("v", 1, 2))["HB1"].cycles(("v", 1, 2), stepz=3)
m.equilibria(("a", 0, 1))[0].simulate(1.0, method="magic")
"""
RIGHT = """
import arclength
from arclength.kingpin import Wheel, WheelPoint

m = arclength.Model(lambda x, p: [-x[0]], ["x"], {"a": 1.0})
m.simulate(1.0, method="implicit", section="x=0", direction="rising", points=10)
branch = m.equilibria(("a", 0, 1))
value: float = branch["HB1"].value
for point in branch:
    point.simulate(1.0)
first, *rest = branch[1:3]
first.cycles(("a", 0, 1))
hopf: WheelPoint = Wheel().hopf(("v", 1, 2))["HB1"]
Wheel().locus(("v", 1, 2), ("l", 1, 2), steps=3)
"""


def test_mistakes_are_seen_by_mypy(tmp_path):
    api = pytest.importorskip("mypy.api")
    options = ["--strict", "--ignore-missing-imports", "--follow-imports=silent", f"--cache-dir={tmp_path}"]
    (tmp_path / "right.py").write_text(RIGHT)
    text, _, code = api.run([*options, str(tmp_path / "right.py")])
    assert code == 0, text
    (tmp_path / "wrong.py").write_text(MISTAKES)
    text, _, _ = api.run([*options, str(tmp_path / "wrong.py")])
    lines = {int(line) for line in re.findall(r"wrong\.py:(\d+): error", text)}
    assert lines == set(range(6, 16)), text


def test_ctrl_c_stops_stability_at():
    code = textwrap.dedent("""
        import signal, threading, time
        import numpy as np
        import arclength
        from arclength.kingpin import Wheel
        points = {"v": np.linspace(1, 10, 20_000_000)}
        threading.Thread(target=lambda: (time.sleep(0.5), signal.raise_signal(signal.SIGINT)), daemon=True).start()
        try:
            Wheel(c_q=0.1).stability_at(points)
        except arclength.Interrupted as interrupted:
            print(interrupted)
    """)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert re.match(r"interrupted after \d+ of 20000000 points", done.stdout), done.stderr


def test_a_wheel_is_read_back_from_what_it_shows():
    wheel = Wheel(r=math.inf, l=0.1, k_u=math.inf)
    assert eval(repr(wheel)) == wheel
    assert np.isinf(eval(repr(wheel)).r)
