"""Files of a sweep: each chunk by itself, whole or not at all, and what says that they belong together."""

from __future__ import annotations

import hashlib
import json
import os
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import ComputationFailed, InvalidInput

if TYPE_CHECKING:
    import pyarrow

#: Files in the folder: the plan, written once before anything else, and the manifest, written when all chunks are there.
PLAN, MANIFEST = "sweep.json", "manifest.json"
#: Key of the identity of a chunk in the metadata of its file.
CHUNK = b"arclength.chunk"


def canonical(value: Any) -> str:
    """A value as a JSON text that is the same for equal values."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=True)


def digest(text: str) -> str:
    """A short hash of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:20]


def _sync_folder(folder: Path) -> None:
    # Not every system lets a folder be opened; there the name of the file is as safe as the system makes it.
    if not hasattr(os, "O_DIRECTORY"):
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _temporary(folder: Path) -> Path:
    return folder / f".{uuid.uuid4().hex}.part"


def publish(folder: Path, name: str, content: bytes, *, once: bool = False) -> bool:
    """Writes a file under another name, has it on the disk, and only then gives it its name. With ``once`` the first one stays."""
    temporary = _temporary(folder)
    try:
        with open(temporary, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if once:
            try:
                os.link(temporary, folder / name)
            except FileExistsError:
                return False
            except OSError as error:
                raise InvalidInput(
                    f"{folder}: no hard link can be made there ({error.strerror}), by which the first of several processes is told; allowed: a "
                    "folder on another file system",
                    key="folder",
                    value=str(folder),
                    allowed="a folder on a file system with hard links",
                ) from error
        else:
            os.replace(temporary, folder / name)
        _sync_folder(folder)
        return True
    finally:
        temporary.unlink(missing_ok=True)


def parquet(table: pyarrow.Table) -> bytes:
    """A table as one Parquet file of one row group."""
    import pyarrow
    import pyarrow.parquet

    out = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, out, compression="zstd", row_group_size=max(table.num_rows, 1))
    content: bytes = out.getvalue().to_pybytes()
    return content


_ARROW = {"number": "float64", "whole number": "int64", "yes or no": "bool_", "word": "string"}


def table(
    columns: Mapping[str, Any], kinds: Mapping[str, str], identity: str, rows: int, given: Mapping[str, Any]
) -> pyarrow.Table:
    """Values of points (``given``) and of answers as a table; what is no number is nothing in it."""
    import numpy as np
    import pyarrow

    arrays: list[Any] = []
    names: list[str] = []
    for name, values in given.items():
        names.append(name)
        arrays.append(pyarrow.array(values.tolist() if values.dtype == object else values))
    for name, kind in kinds.items():
        values = columns.get(name, [None] * rows)
        names.append(name)
        kind_of_arrow = getattr(pyarrow, _ARROW[kind])()
        try:
            if isinstance(values, np.ma.MaskedArray):
                array = pyarrow.array(values.filled(), mask=np.ma.getmaskarray(values), type=kind_of_arrow)
            else:
                array = pyarrow.array(values, type=kind_of_arrow, from_pandas=True)
        except (pyarrow.ArrowException, TypeError) as error:
            raise InvalidInput(
                f"column {name}: {error}; it is a {kind} at the first points; say otherwise by fields={{{name!r}: ...}}",
                key=name,
                allowed=kind,
            ) from error
        arrays.append(array)
    return pyarrow.table(arrays, names=names).replace_schema_metadata({CHUNK: identity})


def kept(folder: Path, name: str, identity: str, chunk: int, rows: int) -> dict[str, Any] | None:
    """The receipt of a chunk whose file is there and is, byte for byte, what was written; else nothing."""
    import pyarrow
    import pyarrow.parquet

    try:
        content = (folder / name).read_bytes()
        written = (folder / _hash_name(name)).read_bytes()
    except FileNotFoundError:
        return None
    found = receipt(name, content, chunk, rows)
    if written != _hash_line(found):
        return None
    try:
        metadata = pyarrow.parquet.read_metadata(pyarrow.BufferReader(content))
    except (pyarrow.ArrowException, OSError):
        return None
    return found if metadata.num_rows == rows and (metadata.metadata or {}).get(CHUNK) == identity.encode() else None


def keep(folder: Path, name: str, content: bytes, chunk: int, rows: int) -> dict[str, Any]:
    """Writes a chunk, beside it first its hash, and gives its receipt. Whatever is on the disk, the receipt is of what was computed."""
    told = receipt(name, content, chunk, rows)
    publish(folder, _hash_name(name), _hash_line(told))
    publish(folder, name, content)
    return told


def _hash_name(name: str) -> str:
    return f"{name.removesuffix('.parquet')}.sha256"


def _hash_line(told: Mapping[str, Any]) -> bytes:
    # As `sha256sum --check` reads it.
    return f"{told['sha256']}  {told['file']}\n".encode()


def receipt(name: str, content: bytes, chunk: int, rows: int) -> dict[str, Any]:
    """What is told of a chunk with this content."""
    return {"chunk": chunk, "file": name, "rows": rows, "bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def sealed(document: Mapping[str, Any]) -> bytes:
    """A plan as the content of its file, with its own hash in it."""
    return canonical({**document, "sha256": hashlib.sha256(canonical(document).encode()).hexdigest()}).encode()


def read_plan(folder: Path) -> dict[str, Any]:
    """The plan in a folder."""
    path = folder / PLAN
    document: Any = read_json(path)
    if isinstance(document, dict):
        told = document.pop("sha256", None)
        if told is None or told == hashlib.sha256(canonical(document).encode()).hexdigest():
            return document
    raise InvalidInput(
        f"{path}: it is not what was written; allowed: another folder, where the sweep is computed anew",
        key="folder",
        value=str(folder),
        allowed="another folder",
    )


def read_json(path: Path) -> Any:
    """A file of this folder."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InvalidInput(
            f"{path}: there is no such file; the folder is none of a sweep, or its chunks are not merged yet", key="folder", value=str(path)
        ) from None
    except ValueError as error:
        raise InvalidInput(f"{path}: not JSON: {error}", key="folder", value=str(path)) from None


def read_chunk(folder: Path, entry: Mapping[str, Any]) -> pyarrow.Table:
    """The rows of a chunk in the manifest; refused where the file is not what was written."""
    import pyarrow.parquet

    path = folder / entry["file"]
    content = path.read_bytes() if path.exists() else b""
    if hashlib.sha256(content).hexdigest() != entry["sha256"]:
        raise ComputationFailed(f"{path}: it is not what the manifest says; the same sweep computes it again")
    table: pyarrow.Table = pyarrow.parquet.read_table(pyarrow.BufferReader(content)).replace_schema_metadata(None)
    return table


def write_merged(folder: Path, files: Sequence[Mapping[str, Any]], out: Path) -> None:
    """All chunks as one Parquet file, a row group for each, so that no more than one is in memory at a time."""
    import pyarrow.parquet

    temporary = _temporary(out.parent)
    writer = None
    try:
        for entry in files:
            chunk = read_chunk(folder, entry)
            if writer is None:
                writer = pyarrow.parquet.ParquetWriter(temporary, chunk.schema, compression="zstd")
            writer.write_table(chunk, row_group_size=max(chunk.num_rows, 1))
        if writer is not None:
            writer.close()
            with open(temporary, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(temporary, out)
            _sync_folder(out.parent)
    finally:
        temporary.unlink(missing_ok=True)
