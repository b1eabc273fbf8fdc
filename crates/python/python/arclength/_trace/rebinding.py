"""Functions with what they reach replaced: modules, functions, and what of Python's own must know values.

The code of a function stays the same; the names in it are bound to something else, in copies of its globals, its closure and its defaults. So
are the functions that it calls, those of modules of Python, those in lists and dictionaries, and the methods of objects.
"""

from __future__ import annotations

import abc
import builtins
import copy
import enum
import functools
import math
import operator
import random
import sys
import types
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from . import arrays, functions
from .rules import REMEDIES, RULES, no_rule, of_numbers
from .values import Symbol, refusal, typed

#: Packages whose functions are not followed: they get numbers, or are refused.
FOREIGN = frozenset("numpy scipy sympy pandas matplotlib jax jaxlib autograd casadi numba torch tensorflow".split())
#: Modules whose functions differ from call to call.
CHANGING = frozenset(("random", "time", "secrets", "numpy.random"))
_OF_NUMPY = ("numpy", "numpy.linalg", "jax.numpy", "jax.numpy.linalg", "scipy.special", "autograd.numpy")


class _AsFloat(type):
    """``float`` in a function: for values too, and equal to ``float`` wherever it is asked for."""

    def __instancecheck__(cls, value: Any) -> bool:
        return isinstance(value, cls.plain)

    def __subclasscheck__(cls, other: Any) -> bool:
        return issubclass(other, cls.plain)

    def __call__(cls, *values: Any) -> Any:
        value = values[0] if len(values) == 1 else None
        if isinstance(value, np.ndarray) and arrays.has_symbols(value) and value.size == 1:
            value = value.item()
        return typed(value, cls.plain) if type(value) is Symbol else cls.plain(*values)

    def __eq__(cls, other: object) -> bool:
        return other is cls or other is cls.plain

    def __hash__(cls) -> int:
        return hash(cls.plain)

    def __getattr__(cls, name: str) -> Any:
        return getattr(cls.plain, name)

    plain: Any


class Float(metaclass=_AsFloat):
    plain = float
    dtype = np.dtype(float)


class Float64(metaclass=_AsFloat):
    plain = np.float64
    dtype = np.dtype(float)


class Function:
    """A function of NumPy that takes symbols, also in lists, and whose arrays take symbols."""

    def __init__(self, function: Any) -> None:
        self._function = function

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        if isinstance(self._function, np.ufunc):
            return arrays.call_ufunc(self._function, "__call__", arguments, keywords)
        return functions.call_function(self._function, arguments, keywords)

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._function, name)
        if isinstance(self._function, np.ufunc) and callable(value):
            return lambda *arguments, **keywords: arrays.call_ufunc(self._function, name, arguments, keywords)
        return value


class Joining:
    """``np.r_`` and ``np.c_``."""

    def __init__(self, plain: Any) -> None:
        self._plain = plain

    def __getitem__(self, key: Any) -> Any:
        entries = key if isinstance(key, tuple) else (key,)
        return arrays.wrapped(self._plain[tuple(arrays.plain(item) if arrays.has_symbols(item) else arrays.realized(item) for item in entries)])


def of_numpy(name: str, function: Any) -> Any:
    if name in ("r_", "c_"):
        return Joining(function)
    if name in functions.CREATION:
        return functions.CREATION[name]
    if function is np.float64:
        return Float64
    if isinstance(function, np.ufunc) or (callable(function) and not isinstance(function, type)):
        return Function(function)
    return function


def of_math(name: str, function: Any) -> Any:
    if not callable(function):
        return function

    def scalar(*values: Any, **keywords: Any) -> Any:
        values = tuple(list(value) if hasattr(type(value), "__next__") else value for value in values)
        if not arrays.has_symbols(values):
            return function(*arrays.realized(values), **keywords)
        if keywords:
            raise refusal(f"math.{name} with {', '.join(keywords)}", "write it by arithmetic")
        if name in ("fsum", "prod"):
            return functools.reduce(operator.add if name == "fsum" else operator.mul, values[0])
        if name not in RULES and name not in ("trunc", "hypot"):
            raise no_rule(name if name in REMEDIES else f"math.{name}")
        given = [typed(value.item() if isinstance(value, np.ndarray) else value, float) for value in values]
        if name == "log" and len(given) == 2:
            return scalar(given[0]) / (scalar(given[1]) if type(given[1]) is Symbol else math.log(given[1]))
        if name == "hypot":
            return typed(np.sqrt(functools.reduce(operator.add, [value * value for value in given])), float)
        if name in ("floor", "ceil", "trunc"):
            return getattr(math, name)(given[0])
        return typed(of_numbers(name, tuple(given)), float)

    return scalar


def changing(name: str, value: Any) -> Any:
    """What differs from call to call is refused when it is called; generators with a seed of their own are not."""
    if not callable(value):
        return value

    def refused(*arguments: Any, **keywords: Any) -> Any:
        if isinstance(value, type) or name in ("default_rng", "RandomState"):
            if [given for given in (*arguments, *keywords.values()) if given is not None]:
                return value(*arguments, **keywords)
        raise refusal(
            f"{name}, which gives another number each time", "draw numbers outside of the function, and keep them in a parameter or a constant"
        )

    return refused


class Generator:
    """A generator of random numbers that was made outside of the function."""

    def __getattr__(self, name: str) -> Any:
        return changing(name, getattr)


class Module(types.ModuleType):
    """A module whose members are replaced."""

    def __init__(self, module: types.ModuleType, replaced: Callable[[str, Any], Any]) -> None:
        super().__init__(module.__name__)
        object.__getattribute__(self, "__dict__").update(_module=module, _replaced=replaced)

    def __getattribute__(self, name: str) -> Any:
        inside = object.__getattribute__(self, "__dict__")
        if name in ("__dict__", "__class__"):
            return vars(inside["_module"]) if name == "__dict__" else types.ModuleType
        value = getattr(inside["_module"], name)
        return value if name.startswith("__") else inside["_replaced"](name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(object.__getattribute__(self, "__dict__")["_module"], name, value)


def _is_foreign(name: str) -> bool:
    return name.partition(".")[0] in FOREIGN


def _module_of(value: Any) -> str:
    """Where it was made: what decorators write into ``__module__`` does not count."""
    name = value.__globals__.get("__name__") if isinstance(value, types.FunctionType) else getattr(value, "__module__", None)
    return name if isinstance(name, str) else ""


class Rebinding:
    """What a function reaches, with its modules and functions replaced; each thing once."""

    def __init__(self) -> None:
        #: By identity, with what was replaced: it must not be freed, or another would have its identity.
        self.done: dict[int, tuple[Any, Any]] = {}
        self.globals: dict[int, dict[str, Any]] = {}
        self.rebound: dict[int, set[str]] = {}
        self.builtins = {
            **vars(builtins),
            "min": _extreme("min", "np.minimum"),
            "max": _extreme("max", "np.maximum"),
            "float": Float,
            "print": _printed,
            "super": self._super,
            "__import__": self._import,
        }

    def value(self, value: Any) -> Any:
        """What a name is bound to."""
        if id(value) in self.done:
            return self.done[id(value)][1]
        if type(value) in (Module, Function, Joining, Generator):
            return value
        if value is float or value is np.float64:
            return Float if value is float else Float64
        if isinstance(value, types.ModuleType):
            return self._kept(value, self._module(value))
        if isinstance(value, np.ufunc):
            return of_numpy(value.__name__, value)
        if isinstance(value, (random.Random, np.random.Generator, np.random.RandomState)):
            return Generator()
        module = _module_of(value)
        if callable(value) and not isinstance(value, (type, types.MethodType)):
            if isinstance(getattr(value, "__self__", None), (random.Random, np.random.RandomState)) or module in CHANGING:
                return changing(value.__name__, value)
            if module == "math":
                return of_math(value.__name__, value)
            if module.partition(".")[0] == "numpy" and hasattr(value, "__name__"):
                return of_numpy(value.__name__, value)
        if isinstance(value, np.ndarray):
            if type(value) is np.ndarray and value.dtype.kind in "fiub":
                return value.view(arrays.NumberArray)
            return arrays.wrapped(value)
        return self.callable(value)

    def callable(self, value: Any) -> Any:
        """A function of Python, or what has some inside."""
        if id(value) in self.done:
            return self.done[id(value)][1]
        if isinstance(value, types.MethodType):
            if isinstance(value.__self__, (random.Random, np.random.Generator)):
                return changing(value.__name__, value)
            return types.MethodType(self.callable(value.__func__), self.value(value.__self__))
        if isinstance(value, functools.partial):
            inner = [self.value(item) for item in value.args]
            return functools.partial(self.value(value.func), *inner, **{key: self.value(item) for key, item in value.keywords.items()})
        if isinstance(value, np.vectorize):
            again = copy.copy(value)
            again.pyfunc = self.value(value.pyfunc)
            return again
        compiled = _compiled(value)
        if compiled is not None:
            return self.value(compiled)
        if type(value) in (list, tuple, dict):
            return self._container(value)
        if isinstance(value, types.FunctionType):
            dispatch = getattr(value, "dispatch", None)
            if dispatch is not None and hasattr(value, "registry"):
                # functools.singledispatch
                return lambda *given, **keywords: self.value(dispatch(given[0].__class__))(*given, **keywords)
            return _foreign(value) if _is_foreign(_module_of(value)) else self._function(value)
        if callable(value) and not isinstance(value, type) and _is_foreign(getattr(value, "__module__", None) or type(value).__module__):
            # Polynomials of NumPy are objects that act on values.
            return value if type(value).__module__.partition(".")[0] == "numpy" else _foreign(value)
        return self._object(value)

    def _kept(self, value: Any, replaced: Any) -> Any:
        self.done[id(value)] = (value, replaced)
        return replaced

    def _container(self, value: Any) -> Any:
        if len(value) > 10_000:
            return value
        self._kept(value, value)
        items = value.items() if isinstance(value, dict) else enumerate(value)
        replaced = {key: self.value(item) for key, item in items}
        if all(replaced[key] is item for key, item in items) if isinstance(value, dict) else all(map(operator.is_, replaced.values(), value)):
            return value
        return self._kept(value, replaced if isinstance(value, dict) else type(value)(replaced.values()))

    def _function(self, value: types.FunctionType) -> Any:
        names = self._names(value)
        cells = None if value.__closure__ is None else tuple(types.CellType() for _ in value.__closure__)
        function = types.FunctionType(value.__code__, names, value.__name__, None, cells)
        self._kept(value, function)
        function.__dict__.update(value.__dict__)
        function.__defaults__ = None if value.__defaults__ is None else tuple(map(self.value, value.__defaults__))
        if value.__kwdefaults__:
            function.__kwdefaults__ = {key: self.value(item) for key, item in value.__kwdefaults__.items()}
        for own, cell in zip(cells or (), value.__closure__ or (), strict=True):
            try:
                own.cell_contents = self.value(cell.cell_contents)
            except ValueError:
                continue  # a name that has no value yet
        return function

    def _names(self, value: types.FunctionType) -> dict[str, Any]:
        """The globals of a function, of which one copy is shared by the functions of a module."""
        key = id(value.__globals__)
        if key not in self.globals:
            self._kept(value.__globals__, value.__globals__)
            self.globals[key] = {**value.__globals__, "__builtins__": self.builtins}
            self.rebound[key] = set()
        names, rebound = self.globals[key], self.rebound[key]
        for name in sorted(_names_in(value.__code__)):
            if name in rebound:
                continue
            rebound.add(name)
            if name in names and name != "__builtins__":
                names[name] = self.value(names[name])
        return names

    def _object(self, value: Any) -> Any:
        """An object of a class of Python: one that shares its attributes, and whose methods are replaced."""
        kind = type(value)
        if (
            not isinstance(getattr(value, "__dict__", None), dict)
            or kind.__module__ in ("builtins", "types", "functools")
            or kind.__module__.partition(".")[0] in FOREIGN | sys.stdlib_module_names - {"__main__"} | {"arclength"}
            or isinstance(value, (type, enum.Enum, BaseException, types.ModuleType, Mapping))
            or not _is_plain(kind)
        ):
            return value
        replace = self.value

        def attribute(self: Any, name: str) -> Any:
            own = next((vars(base)[name] for base in kind.__mro__ if name in vars(base)), None)
            if isinstance(own, property) and own.fget is not None:
                return replace(own.fget)(self)
            found = super(made, self).__getattribute__(name)
            return found if name.startswith("__") else replace(found)

        methods = {
            name: method
            for base in reversed(kind.__mro__[:-1])
            for name, method in vars(base).items()
            if isinstance(method, types.FunctionType) and name.startswith("__") and name not in ("__new__", "__init__", "__del__", "__getattribute__")
        }
        try:
            metaclass: Any = type(kind)
            made: Any = metaclass(kind.__name__, (kind,), {"__module__": kind.__module__, "__qualname__": kind.__qualname__})
            again = object.__new__(made)
        except TypeError:
            return value
        object.__setattr__(again, "__dict__", value.__dict__)
        self._kept(value, again)
        self._kept(again, again)
        for name, method in methods.items():
            setattr(made, name, self.callable(method))
        if "__getattribute__" not in vars(kind):
            made.__getattribute__ = attribute
        return again

    def _super(self, *given: Any) -> Any:
        """``super()``, with the methods replaced."""
        if not given:
            frame = sys._getframe(1)
            given = (frame.f_locals["__class__"], frame.f_locals[frame.f_code.co_varnames[0]])
        above: Any = super
        return _Above(above(*given), self.value)

    def _module(self, module: types.ModuleType) -> types.ModuleType:
        name = module.__name__
        if name == "math":
            return Module(module, of_math)
        if name in CHANGING:
            return Module(module, changing)
        if name in _OF_NUMPY:
            return Module(np if name.endswith(".numpy") else module, self._member(of_numpy))
        if _is_foreign(name):
            return Module(module, self._member(lambda _, value: self.value(value)))
        if name.partition(".")[0] in sys.stdlib_module_names and name != "__main__":
            return module
        return Module(module, self._member(lambda _, value: self.value(value)))

    def _member(self, replaced: Callable[[str, Any], Any]) -> Callable[[str, Any], Any]:
        return lambda name, value: self.value(value) if isinstance(value, types.ModuleType) else replaced(name, value)

    def _import(self, *arguments: Any, **keywords: Any) -> Any:
        return self.value(builtins.__import__(*arguments, **keywords))


class _Above:
    def __init__(self, found: Any, replace: Callable[[Any], Any]) -> None:
        self._found, self._replace = found, replace

    def __getattr__(self, name: str) -> Any:
        return self._replace(getattr(self._found, name))


def _is_plain(kind: type) -> bool:
    """Whether its objects hold nothing but attributes, and a class made of it does nothing of its own."""
    heap = 1 << 9
    return (
        type(kind) in (type, abc.ABCMeta)
        and "__init_subclass__" not in {name for base in kind.__mro__[:-1] for name in vars(base)}
        and all(base.__flags__ & heap and not getattr(base, "__slots__", ()) for base in kind.__mro__[:-1])
    )


def _compiled(value: Any) -> Any:
    """The function that a decorator compiles, or whose results it keeps, and does not change."""
    if isinstance(value, type):
        return None
    inner = getattr(value, "py_func", None)
    kind = type(value)
    if inner is None and (kind is type(functools.lru_cache(len)) or kind.__module__.partition(".")[0] in ("jax", "jaxlib", "numba")):
        inner = getattr(value, "__wrapped__", None)
    return inner if callable(inner) else None


def _foreign(function: Any) -> Callable[..., Any]:
    """A function of another package: of arrays without values it is called."""

    def called(*arguments: Any, **keywords: Any) -> Any:
        if arrays.has_symbols((*arguments, *keywords.values())):
            name = f"{function.__module__}.{getattr(function, '__name__', type(function).__name__)}"
            raise no_rule(name)
        return functions.constant_call(function, arguments, keywords)

    return called


def _extreme(name: str, remedy: str) -> Callable[..., Any]:
    plain = getattr(builtins, name)

    def function(*values: Any, **keywords: Any) -> Any:
        if len(values) == 1 and not isinstance(values[0], Symbol):
            values = (list(values[0]),)
        if arrays.has_symbols(values):
            raise refusal(f"the function {name} of Python", f"write {remedy}(a, b) in place of it")
        return plain(*values, **keywords)

    return function


def _printed(*values: Any, **keywords: Any) -> None:
    print(*[repr(value) if arrays.has_symbols(value) else value for value in values], **keywords)


def _names_in(code: types.CodeType) -> set[str]:
    """Global names in a code and those inside it."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names_in(constant)
    return names
