"""Exceptions and warnings of the package: one hierarchy, for every analysis.

Every exception has ``key`` (what was at fault: a parameter, a keyword, a name), ``value`` (what was given) and ``allowed`` (what is
allowed), each a text, or ``None`` where that is not known.
"""

from __future__ import annotations

import re

__all__ = [
    "AnalysisWarning",
    "ArclengthError",
    "ComputationFailed",
    "Interrupted",
    "InvalidInput",
    "InvalidModel",
    "NotTraceable",
    "UnknownLabel",
]


#: How messages say what is allowed.
_ALLOWED = re.compile(r"(?:; allowed: |is not allowed: |; the (?:keys|states) are |; there are: )(?P<allowed>[^\n]*)")


class ArclengthError(Exception):
    """Whatever this package raises."""

    key: str | None
    value: str | None
    allowed: str | None

    def __init__(
        self, message: str, *, key: str | None = None, value: str | None = None, allowed: str | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.key = key
        self.value = value
        told = _ALLOWED.search(message) if allowed is None else None
        self.allowed = allowed if told is None else told["allowed"]

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[object, ...]:
        details = {"key": self.key, "value": self.value, "allowed": self.allowed}
        return (_again, (type(self), self.message, details), self.__dict__)


def _again(kind: type[ArclengthError], message: str, details: dict[str, str | None]) -> ArclengthError:
    return kind(message, **details)


class InvalidInput(ArclengthError, ValueError):
    """What was asked for makes no sense: the message says what is wrong, what is allowed and what to do."""


class InvalidModel(InvalidInput):
    """The text of a model that cannot be read, with line and column."""


class NotTraceable(InvalidInput):
    """A Python function that is no model: the message says where, why, and what to write in place of it.

    ``filename`` and ``line`` say where, if that is known.
    """

    filename: str | None = None
    line: int | None = None


class UnknownLabel(InvalidInput, KeyError):
    """A label that no point has; ``allowed`` has the labels that there are."""


class ComputationFailed(ArclengthError, RuntimeError):
    """The computation gives no result: the message says why and what to try."""


class Interrupted(ArclengthError, KeyboardInterrupt):
    """Ctrl-C came before there was anything of the result. It is a :class:`KeyboardInterrupt` too."""


class AnalysisWarning(UserWarning):
    """What is worth knowing of a result. It is in ``warnings`` of the result as well."""
