"""The same problems by this package and by what else there is in Python: time to the first result in a new process, size on disk, error.

    python benchmarks/peers.py [--repeat N]

Every peer runs in processes of its own, so that imports and compilation count. What is not installed is left out. The problems have answers
in closed form or published ones:

- hopf: the Hopf point of the feedback control of Lur'e type (Kuznetsov, example 5.4) is at alpha = 1;
- cycle: the cycle of the van der Pol oscillator has the period 6.663286859323130 at mu = 1;
- doubling: the cycles of Lur'e's system double their period at alpha = 0.6303020062 (MatCont's testrun).

SciPy has no continuation: what is written here with it is what one would write, a root of the largest real part and a shooting method.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import statistics
import subprocess
import sys
import time

TRUTH = {"hopf": 1.0, "cycle": 6.663286859323130, "doubling": 0.6303020062}

LURE_SCIPY = """
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve
def lure(x, alpha):
    return np.array([x[1], x[2], -alpha * x[2] - x[1] - x[0] + x[0] ** 2])
def jacobian(f, x, h=1e-6):
    return np.column_stack([(f(x + h * e) - f(x - h * e)) / (2 * h) for e in np.eye(len(x))])
"""

#: Programs by peer and problem; each prints its answer.
PROGRAMS = {
    "arclength": {
        "hopf": """
import arclength
def lure(x, p):
    return [x[1], x[2], -p.alpha * x[2] - x[1] - x[0] + x[0] ** 2]
model = arclength.Model(lure, states=["x", "y", "z"], parameters={"alpha": 2.0})
print(repr(float(model.equilibria(along=("alpha", 0.5, 2))["HB1"].value)))
""",
        "cycle": """
import arclength
def oscillator(x, p):
    return [x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]]
model = arclength.Model(oscillator, states={"x": 2.0, "y": 0.0}, parameters={"mu": 1.0})
print(repr(float(model.simulate(60).end.cycles(along=("mu", 0.9, 1.1), at=1)["AT1"].period)))
""",
        "doubling": """
import arclength
def lure(x, p):
    return [x[1], x[2], -p.alpha * x[2] - x[1] - x[0] + x[0] ** 2]
model = arclength.Model(lure, states=["x", "y", "z"], parameters={"alpha": 2.0})
print(repr(float(model.equilibria(along=("alpha", 0.5, 2))["HB1"].cycles(along=("alpha", 0.5, 2))["PD1"].value)))
""",
    },
    "SciPy": {
        "hopf": LURE_SCIPY
        + """
def growth(alpha):
    x = fsolve(lure, np.zeros(3), args=(alpha,))
    return np.linalg.eigvals(jacobian(lambda x: lure(x, alpha), x)).real.max()
print(repr(float(brentq(growth, 0.5, 2, xtol=1e-14))))
""",
        "cycle": """
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
def flow(state, period):
    rhs = lambda t, x: [x[1], (1 - x[0] ** 2) * x[1] - x[0]]
    return solve_ivp(rhs, (0, period), state, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
start = flow([2.0, 0.0], 60.0)
crossing = solve_ivp(lambda t, x: [x[1], (1 - x[0] ** 2) * x[1] - x[0]], (0, 20), start, events=lambda t, x: x[1], rtol=1e-9)
first, _, third = crossing.t_events[0][:3]
x = crossing.y_events[0][0][0]
print(repr(float(fsolve(lambda u: flow([u[0], 0.0], u[1]) - [u[0], 0.0], [x, third - first], xtol=1e-13)[1])))
""",
        "doubling": LURE_SCIPY
        + """
def flow(state, alpha, period):
    return solve_ivp(lambda t, x: lure(x, alpha), (0, period), state, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
def cycle(alpha, guess):
    return fsolve(lambda u: flow([u[0], 0.0, u[1]], alpha, u[2]) - [u[0], 0.0, u[1]], guess, xtol=1e-11)
found = {}
guess = np.array([0.1, -0.1, 2 * np.pi])
for alpha in np.arange(0.99, 0.6, -0.03):
    guess = found[alpha] = cycle(alpha, guess)
def test(alpha):
    u = cycle(alpha, found[min(found, key=lambda known: abs(known - alpha))])
    monodromy = jacobian(lambda x: flow(x, alpha, u[2]), np.array([u[0], 0.0, u[1]]), 1e-5)
    return np.linalg.det(monodromy + np.eye(3))
print(repr(float(brentq(test, 0.6, 0.66, xtol=1e-12))))
""",
    },
    "JaxCont": {
        "hopf": """
import jax
jax.config.update("jax_enable_x64", True)
import jax.numpy as jnp
import jaxcont as jc
def lure(x, alpha, args):
    return jnp.array([x[1], x[2], -alpha * x[2] - x[1] - x[0] + x[0] ** 2])
problem = jc.bif_problem(lure, u0=jnp.zeros(3), p0=2.0, state_names=["x", "y", "z"], param_name="alpha")
settings = jc.ContinuationPar(ds=-0.03, max_steps=200)
result = jc.continuation(problem, p_span=(2.0, 0.5), settings=settings, events=[jc.Hopf()])
print(repr(float(next(event.p for event in result.events))))
""",
    },
}

#: Names of distributions, whose sizes with all that they need are told.
DISTRIBUTIONS = {"arclength": "arclength", "SciPy": "scipy", "JaxCont": "jaxcont"}


def size_on_disk(name: str, seen: set[str]) -> int:
    """Bytes of a distribution and of those that it needs."""
    import re

    if name in seen:
        return 0
    seen.add(name)
    try:
        distribution = importlib.metadata.distribution(name)
    except importlib.metadata.PackageNotFoundError:
        return 0
    files = [file.locate() for file in distribution.files or []]
    own = sum(file.stat().st_size for file in files if file.is_file())
    needed = [re.split(r"[ ;<>=!~\[(]", entry, maxsplit=1)[0].lower() for entry in distribution.requires or [] if "extra ==" not in entry]
    return own + sum(size_on_disk(other, seen) for other in needed)


def measured(program: str, repeat: int) -> dict[str, object]:
    """The answer of a program, and the seconds that it takes: the median of so many runs."""
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        seconds.append(time.perf_counter() - start)
        if done.returncode != 0:
            return {"problem": done.stderr.strip().splitlines()[-1]}
    return {"answer": float(done.stdout.split()[-1]), "seconds": statistics.median(seconds)}


def main() -> None:
    """Prints a line of JSON for each peer and problem."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=5)
    repeat = parser.parse_args().repeat
    for peer, programs in PROGRAMS.items():
        distribution = DISTRIBUTIONS[peer]
        try:
            version = importlib.metadata.version(distribution)
        except importlib.metadata.PackageNotFoundError:
            print(json.dumps({"peer": peer, "problem": "not installed"}))
            continue
        megabytes = round(size_on_disk(distribution, set()) / 1e6, 1)
        for name, program in programs.items():
            result = measured(program, repeat)
            if "answer" in result:
                result["error"] = abs(float(str(result["answer"])) - TRUTH[name])
            print(json.dumps({"peer": peer, "version": version, "MB": megabytes, "case": name, **result}), flush=True)


if __name__ == "__main__":
    main()
