"""Results that came from another process: what they show and save, without what computed them."""

from __future__ import annotations

import os
import tempfile
import uuid
from typing import Any

from .errors import InvalidInput


def state_of(native: Any) -> dict[str, Any]:
    """All that a result shows, for a pickle of it."""
    if isinstance(native, Copied):
        return native.state
    names = native.column_names()
    with tempfile.TemporaryDirectory(prefix="arclength-") as folder:
        path = os.path.join(folder, "result.csv")
        native.write(path)
        with open(path, "rb") as file:
            csv = file.read()
    return {
        "schema": native.schema,
        "warnings": native.warnings,
        "interrupted": native.interrupted,
        "json": native.json(),
        "table": native.table(),
        "story": native.story(),
        "svg": native.svg(),
        "csv": csv,
        "columns": {name: native.column(name) for name in names},
        "units": native.units(),
    }


class Copied:
    """In place of a result of the native module, with what was kept of it."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.state = state
        self.schema: str = state["schema"]
        self.warnings: list[str] = state["warnings"]
        self.interrupted: bool = state["interrupted"]

    def json(self) -> bytes:
        text: bytes = self.state["json"]
        return text

    def table(self) -> str:
        text: str = self.state["table"]
        return text

    def story(self) -> str | None:
        text: str | None = self.state["story"]
        return text

    def svg(self) -> str | None:
        text: str | None = self.state["svg"]
        return text

    def column_names(self) -> list[str]:
        return list(self.state["columns"])

    def units(self) -> dict[str, str]:
        return dict(self.state["units"])

    def column(self, name: str) -> Any:
        return self.state["columns"].get(name)

    def _arrow(self) -> Any:
        import numpy as np
        import pyarrow

        arrays = [pyarrow.array(column, from_pandas=isinstance(column, np.ndarray)) for column in self.state["columns"].values()]
        units = self.units()
        fields = [
            pyarrow.field(name, array.type, metadata={"unit": units[name]} if name in units else None)
            for name, array in zip(self.state["columns"], arrays, strict=True)
        ]
        return pyarrow.table(arrays, schema=pyarrow.schema(fields))

    def stream(self) -> object:
        return self._arrow().__arrow_c_stream__()

    def write(self, path: str) -> None:
        ending = os.path.splitext(path)[1].lower()
        if ending == ".parquet":
            write_parquet(self._arrow(), path)
            return
        texts = {".json": self.json(), ".csv": self.state["csv"], ".svg": (self.svg() or "").encode()}
        if not texts.get(ending):
            allowed = ", ".join([*(ending for ending, text in texts.items() if text), ".parquet"])
            raise InvalidInput(
                f"{path}: a result that came from another process has no such file; allowed: {allowed}",
                key="path",
                value=path,
                allowed=allowed,
            )
        write_whole(path, texts[ending])


def write_whole(path: str, content: bytes) -> None:
    """Writes a file, whole or not at all."""
    temporary = os.path.join(os.path.dirname(os.path.abspath(path)), f".{uuid.uuid4().hex}.part")
    try:
        try:
            with open(temporary, "xb") as file:
                file.write(content)
            os.replace(temporary, path)
        finally:
            if os.path.exists(temporary):
                os.unlink(temporary)
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}", key="path", value=path) from None


def write_parquet(table: Any, path: str) -> None:
    """Writes a table of Arrow as a Parquet file."""
    import pyarrow
    import pyarrow.parquet

    out = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, out)
    write_whole(path, out.getvalue().to_pybytes())
