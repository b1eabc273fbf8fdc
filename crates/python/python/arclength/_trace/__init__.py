"""Python functions as models: a function is called once with symbols in place of numbers, which record what is done with them.

:mod:`.values` has the symbols, :mod:`.rules` what is recorded for element-wise functions, :mod:`.arrays` and :mod:`.functions` arrays of symbols
and NumPy's functions of them, :mod:`.rebinding` how a function comes to call these, and :mod:`.checking` compares what was recorded with the
function itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .. import _native
from ..errors import ArclengthError, NotTraceable
from ..models import Parameters
from .arrays import SymbolArray, plain
from .rebinding import Rebinding
from .values import Recording, Symbol, is_number, is_users, refused_at

__all__ = ["derivatives", "trace"]

NOT_RECORDED = "what it does cannot be recorded; write it by arithmetic, loops and functions of NumPy and math that act on values"


def derivatives(result: Any, states: Mapping[str, float]) -> list[Any]:
    """What a function returned, as a list in the order of the states."""
    if isinstance(result, Mapping):
        wrong = set(result) ^ set(states)
        if wrong:
            raise NotTraceable(
                f"the function returns derivatives of {', '.join(map(str, result))}; allowed: those of {', '.join(states)}",
                key=", ".join(sorted(map(str, wrong))),
            )
        result = [result[name] for name in states]
    if type(result) is Symbol or is_number(result):
        result = [result]
    if hasattr(type(result), "__next__"):
        result = list(result)
    if result is None:
        raise NotTraceable("the function returns nothing; it must return the derivatives", key="return")
    entries = list(np.asarray(plain(result), dtype=object).ravel()) if not isinstance(result, list) else result
    if len(entries) != len(states):
        raise NotTraceable(
            f"the function returns {len(entries)} derivatives; allowed: {len(states)}, one for each state",
            key="return",
            value=str(len(entries)),
            allowed=str(len(states)),
        )
    return [entry.view(np.ndarray).item() if isinstance(entry, np.ndarray) and entry.size == 1 else entry for entry in entries]


def _raised(error: Exception) -> NotTraceable:
    """What the function raised while it was recorded, with the place."""
    place = None
    trace = error.__traceback__
    while trace is not None:
        if is_users(trace.tb_frame.f_code.co_filename):
            place = (trace.tb_frame.f_code.co_filename, trace.tb_lineno)
        trace = trace.tb_next
    what = f"{type(error).__name__}: {error.args[0] if isinstance(error, KeyError) and error.args else error}"
    return refused_at(what, NOT_RECORDED, *place) if place else NotTraceable(f"{what}; {NOT_RECORDED}", key=what, allowed=NOT_RECORDED)


def trace(function: Callable[[Any, Any], Any], states: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    """The text of the model of a function."""
    if not states:
        raise NotTraceable("a model needs states; allowed: at least one name", key="states")
    if not callable(function):
        raise NotTraceable(f"a {type(function).__name__} is no function; allowed: a function of x and p", key="function")
    recording = Recording(len(states) + len(parameters))
    state = np.empty(len(states), dtype=object)
    state[:] = [Symbol(recording, index) for index in range(len(states))]
    values = {name: Symbol(recording, len(states) + index, float) for index, name in enumerate(parameters)}
    with recording.active():
        called = Rebinding().value(function)
        try:
            result = called(state.view(SymbolArray), Parameters(values))
            indices = [recording.symbol(entry).index for entry in derivatives(result, states)]
        except ArclengthError:
            if recording.refused:
                raise recording.refused[0] from None
            raise
        except Exception as error:
            if recording.refused:
                raise recording.refused[0] from error
            raise _raised(error) from error
    if recording.refused:
        # The function caught it, and went on with something else.
        raise recording.refused[0]
    return _native.build_model(list(states.items()), list(parameters.items()), recording.operations, indices)
