"""Models of other packages: expressions of CasADi, and SBML and Antimony by way of COPASI's export to XPPAUT's format."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable, Mapping
from typing import Any

from .errors import InvalidInput, InvalidModel, NotTraceable

Function = Callable[[Any, Any], list[Any]]


def of_casadi(system: Mapping[str, Any]) -> tuple[Function, list[str], list[str]]:
    """The right-hand side of a system ``{"x": .., "p": .., "ode": ..}`` of SX as a function, with the names of states and parameters."""
    import casadi

    x, p = casadi.vec(system["x"]), casadi.vec(system.get("p", casadi.SX(0, 1)))
    rhs = casadi.Function("rhs", [x, p], [casadi.vec(system["ode"])])
    if not rhs.is_a("SXFunction"):
        raise InvalidInput("the system is not one of SX; allowed: casadi.SX", key="system", allowed="casadi.SX")
    rules = _casadi_rules(casadi)
    steps: list[tuple[int, list[int], list[int], float]] = []
    for k in range(rhs.n_instructions()):
        code = rhs.instruction_id(k)
        constant = rhs.instruction_constant(k) if code == casadi.OP_CONST else 0.0
        if code not in (casadi.OP_CONST, casadi.OP_INPUT, casadi.OP_OUTPUT) and code not in rules:
            name = next((name for name in dir(casadi) if name.startswith("OP_") and getattr(casadi, name) == code), str(code))
            raise NotTraceable(
                f"{name}: there is no rule for this operation of CasADi; write it by others", key=name, allowed=", ".join(_names(casadi, rules))
            )
        steps.append((code, list(rhs.instruction_input(k)), list(rhs.instruction_output(k)), constant))
    size, count = rhs.sz_w(), x.numel()

    def function(state: Any, parameters: Any) -> list[Any]:
        given = [list(state), list(parameters.values())]
        work: list[Any] = [0.0] * size
        derivatives: list[Any] = [0.0] * count
        for code, inputs, outputs, constant in steps:
            if code == casadi.OP_CONST:
                work[outputs[0]] = constant
            elif code == casadi.OP_INPUT:
                work[outputs[0]] = given[inputs[0]][inputs[1]]
            elif code == casadi.OP_OUTPUT:
                derivatives[outputs[1]] = work[inputs[0]]
            else:
                work[outputs[0]] = rules[code](*(work[index] for index in inputs))
        return derivatives

    return function, [str(x[index]) for index in range(count)], [str(p[index]) for index in range(p.numel())]


def _casadi_rules(casadi: Any) -> dict[int, Callable[..., Any]]:
    import numpy as np

    def log1p(a: Any) -> Any:
        # With what rounding of 1 + a has lost: no choice of formulas, which would be a kink.
        rounded = 1.0 + a
        return np.log(rounded) + (a - (rounded - 1.0)) / rounded

    rules: dict[str, Callable[..., Any]] = {
        "ASSIGN": lambda a: a,
        "ADD": lambda a, b: a + b,
        "SUB": lambda a, b: a - b,
        "MUL": lambda a, b: a * b,
        "DIV": lambda a, b: a / b,
        "NEG": lambda a: -a,
        "POW": lambda a, b: a**b,
        "CONSTPOW": lambda a, b: a**b,
        "SQ": lambda a: a * a,
        "TWICE": lambda a: a + a,
        "INV": lambda a: 1.0 / a,
        "LT": lambda a, b: np.where(a < b, 1.0, 0.0),
        "LE": lambda a, b: np.where(a <= b, 1.0, 0.0),
        "EQ": lambda a, b: np.where(a == b, 1.0, 0.0),
        "NE": lambda a, b: np.where(a != b, 1.0, 0.0),
        "NOT": lambda a: np.where(a == 0.0, 1.0, 0.0),
        "AND": lambda a, b: np.where(a * b != 0.0, 1.0, 0.0),
        "OR": lambda a, b: np.where(abs(a) + abs(b) != 0.0, 1.0, 0.0),
        "IF_ELSE_ZERO": lambda a, b: np.where(a != 0.0, b, 0.0),
        "FABS": abs,
        "FMIN": np.minimum,
        "FMAX": np.maximum,
        "LOG1P": log1p,
        "EXPM1": np.expm1,
        "HYPOT": lambda a, b: np.sqrt(a * a + b * b),
    }
    same = {"EXP": "exp", "LOG": "log", "SQRT": "sqrt", "FLOOR": "floor", "CEIL": "ceil", "SIGN": "sign"}
    same |= {name: name.lower() for name in ("SIN", "COS", "TAN", "SINH", "COSH", "TANH")}
    same |= {f"A{name}": f"arc{name.lower()}" for name in ("SIN", "COS", "TAN", "TAN2")}
    rules |= {name: getattr(np, function) for name, function in same.items()}
    return {getattr(casadi, f"OP_{name}"): rule for name, rule in rules.items() if hasattr(casadi, f"OP_{name}")}


def _names(casadi: Any, rules: Mapping[int, Any]) -> list[str]:
    return sorted(name for name in dir(casadi) if name.startswith("OP_") and getattr(casadi, name) in rules)


def ode_of_sbml(text: str) -> str:
    """An SBML document in XPPAUT's format, by COPASI."""
    import COPASI

    model = COPASI.CRootContainer.addDatamodel()
    try:
        if not model.importSBMLFromString(text):
            raise InvalidModel(f"COPASI cannot read it as SBML: {COPASI.CCopasiMessage.getAllMessageText()}", key="sbml")
        events = model.getModel().getNumEvents()
        if events:
            # The export would leave them out without a word.
            raise InvalidModel(
                f"the model has events ({events}), which COPASI does not export; allowed: models without; write it as an .ode file with "
                "`global` lines",
                key="sbml",
                allowed="models without events",
            )
        with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
            path = os.path.join(folder, "model.ode")
            if not model.exportMathModel(path, None, "XPPAUT (*.ode)", True):
                raise InvalidModel(f"COPASI cannot export it: {COPASI.CCopasiMessage.getAllMessageText()}", key="sbml")
            with open(path, encoding="utf-8") as file:
                return file.read()
    finally:
        COPASI.CRootContainer.removeDatamodel(model)


def sbml_of_antimony(text: str) -> str:
    """A model in Antimony as an SBML document."""
    import antimony

    antimony.clearPreviousLoads()
    if antimony.loadAntimonyString(text) < 0:
        raise InvalidModel(f"Antimony: {antimony.getLastError()}", key="antimony")
    sbml: str = antimony.getSBMLString(antimony.getMainModuleName())
    return sbml
