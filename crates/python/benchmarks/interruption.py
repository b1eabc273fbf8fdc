"""Ctrl-C at random moments: how long it takes until an analysis gives up, and whether any is lost, hangs or crashes.

    python benchmarks/interruption.py [--count 100] [--seed 1]
"""

from __future__ import annotations

import argparse
import random
import statistics
import subprocess
import sys

PROGRAM = """
import signal, sys, threading, time, warnings
import arclength
from arclength.kingpin import Wheel
warnings.simplefilter("ignore")
fine = {"finer": 100000, "steps": 10000000}
branch = arclength.Model.from_ode("par a=-1, b=1\\nx'=y+a*x-x^3\\ny'=-b*x\\ndone\\n").equilibria(("a", -1, 1))
endless = arclength.Model.from_ode("x'=y\\ny'=-x\\ninit x=1\\n@ total=1e8\\ndone\\n")
straight = Wheel(r=float("inf"), l=0.04)
run = {
    "equilibria": lambda: branch.of_model.equilibria(("a", -1, 1), **fine),
    "cycles": lambda: branch["HB1"].cycles(("a", -1, 1), **fine),
    "locus": lambda: branch["HB1"].locus(("a", -1, 1), ("b", 0.5, 2), **fine),
    "simulate": lambda: endless.simulate(points=10),
    "chart": lambda: Wheel().chart(("v", 0.1, 12, 3000), ("l", 0.02, 0.3, 3000)),
    "wheel cycles": lambda: Wheel().cycles(("v", 0.2, 9), **fine),
    "basin": lambda: Wheel(v=6).basin(("psi", -1, 1, 300), ("Omega", -60, 60, 300)),
    "safe_kick": lambda: [Wheel(v=6 + i / 100).safe_kick() for i in range(100)],
    "margin": lambda: Wheel().margin(("v", 1, 8, 150)),
    "damper": lambda: [straight.damper(3 + i / 100) for i in range(100)],
}[sys.argv[1]]
def interrupt():
    time.sleep(float(sys.argv[2]))
    sent.append(time.perf_counter())
    signal.raise_signal(signal.SIGINT)
sent = []
try:
    threading.Thread(target=interrupt, daemon=True).start()
    while True:
        result = run()
        if getattr(result, "interrupted", False):
            break
except KeyboardInterrupt:
    pass
print(time.perf_counter() - sent[0])
"""
ANALYSES = ("equilibria", "cycles", "locus", "simulate", "chart", "wheel cycles", "basin", "safe_kick", "margin", "damper")


def main() -> None:
    """Prints the slowest of each analysis, and all together."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    moments = random.Random(asked.seed)
    seconds: dict[str, list[float]] = {name: [] for name in ANALYSES}
    wrong = []
    for index in range(asked.count):
        name = ANALYSES[index % len(ANALYSES)]
        delay = f"{moments.uniform(0.0, 1.0):.3f}"
        try:
            done = subprocess.run([sys.executable, "-c", PROGRAM, name, delay], capture_output=True, text=True, timeout=60)
        except subprocess.TimeoutExpired:
            wrong.append(f"{name} at {delay} s: hangs")
            continue
        if done.returncode != 0 or not done.stdout:
            wrong.append(f"{name} at {delay} s: exit code {done.returncode} {done.stderr[-300:]}")
            continue
        seconds[name].append(float(done.stdout))
    for name, taken in seconds.items():
        if taken:
            print(f"{name:14} {len(taken):4} slowest {max(taken):.3f} s, median {statistics.median(taken):.3f} s")
    every = sorted(value for taken in seconds.values() for value in taken)
    print(f"all {len(every)}: slowest {every[-1]:.3f} s, median {statistics.median(every):.3f} s, over 0.2 s: {sum(value > 0.2 for value in every)}")
    for line in wrong:
        print(line)


if __name__ == "__main__":
    main()
