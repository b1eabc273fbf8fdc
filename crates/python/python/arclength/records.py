"""What is in a result: records with named fields, arrays where there are lists of numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

#: Fields whose pairs of numbers are real and imaginary parts.
COMPLEX = frozenset({"eigenvalues", "multipliers", "eigenvector"})


class Record(Mapping[str, Any]):
    """Named fields, as ``record["name"]`` and as ``record.name``."""

    __slots__ = ("_fields",)

    def __init__(self, fields: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_fields", dict(fields))

    def __getitem__(self, name: str) -> Any:
        return self._fields[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def __eq__(self, other: object) -> bool:
        return same(self, other) if isinstance(other, Mapping) else NotImplemented

    # Fields may be arrays.
    __hash__ = None  # type: ignore[assignment]

    def __getattr__(self, name: str) -> Any:
        try:
            return object.__getattribute__(self, "_fields")[name]
        except KeyError:
            known = ", ".join(object.__getattribute__(self, "_fields"))
            raise AttributeError(f"there is no field `{name}`; there are: {known}") from None

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("records do not change")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._fields})

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self._fields.items())
        return f"{type(self).__name__}({inside})"

    def __reduce__(self) -> tuple[object, ...]:
        return (type(self), (self._fields,))


def same(first: Any, second: Any) -> bool:
    """Whether two values are equal, arrays as a whole; what is not a number is equal to itself."""
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        return first.keys() == second.keys() and all(same(value, second[name]) for name, value in first.items())
    if isinstance(first, (list, tuple)) and isinstance(second, (list, tuple)):
        return len(first) == len(second) and all(map(same, first, second))
    if hasattr(first, "dtype") or hasattr(second, "dtype"):
        import numpy as np

        one, other = np.asarray(first), np.asarray(second)
        if one.shape != other.shape:
            return False
        if one.dtype.kind in "fc" and other.dtype.kind in "fc":
            return bool(np.array_equal(one, other, equal_nan=True))
        return all(map(same, one.ravel().tolist(), other.ravel().tolist()))
    return bool(first == second) or (first != first and second != second)


def tidy(value: Any, name: str = "") -> Any:
    """What was read from JSON as records, arrays and numbers: ``"inf"`` is infinity, and a number that is missing in a list is none."""
    if isinstance(value, dict):
        return Record({name: tidy(entry, name) for name, entry in value.items()})
    if isinstance(value, list):
        return _array(value, name)
    if value == "inf" or value == "-inf":
        return float(value)
    return value


def _array(values: list[Any], name: str) -> Any:
    import numpy as np

    is_number = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
    if values and (is_number or all(value is None or isinstance(value, (int, float)) for value in values)):
        if any(isinstance(value, bool) for value in values):
            return np.array(values, dtype=object if any(value is None for value in values) else bool)
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    if values and all(isinstance(value, list) for value in values):
        rows = [_array(value, "") for value in values]
        alike = all(isinstance(row, np.ndarray) and row.shape == rows[0].shape for row in rows)
        if alike and rows[0].dtype == float:
            array = np.array(rows)
            if name in COMPLEX and array.shape[-1] == 2:
                return array[..., 0] + 1j * array[..., 1]
            return array
        return tuple(rows)
    return tuple(tidy(value) for value in values)
