"""What tests share: models, and the programs of the package as processes of their own."""

import subprocess
import sys
from pathlib import Path

import pytest

LURE = """# Feedback-control system of Lur'e type (Kuznetsov, Elements of Applied Bifurcation Theory, example 5.4).
par alpha=2, beta=1
x' = y
y' = z
z' = -alpha*z - beta*y - x + x^2
done
"""


@pytest.fixture
def lure() -> str:
    return LURE


@pytest.fixture
def program(tmp_path: Path):
    """Runs one of the programs in an empty folder."""

    def run(name: str, *arguments: str) -> "subprocess.CompletedProcess[str]":
        path = Path(sys.executable).with_name(name)
        return subprocess.run([str(path), *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=120)

    return run
