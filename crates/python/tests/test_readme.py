"""The examples of the package's README and docstrings run."""

import doctest
import os
import re
from pathlib import Path

import pytest

import arclength
import arclength.kingpin

README = Path(__file__).parent.parent / "README.md"


def test_readme(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)
    assert {"lure.svg"} <= set(os.listdir(tmp_path))


@pytest.mark.parametrize("module", [arclength, arclength.kingpin])
def test_docstrings(module):
    failed, tried = doctest.testmod(module)
    assert tried > 0
    assert failed == 0
