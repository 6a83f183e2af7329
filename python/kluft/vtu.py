"""The one reader of the field files (VTK XML, arrays behind the XML, plain or compressed) that a run writes. It needs nothing but
NumPy."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path

import numpy as np

_TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1"}
_START = b'<AppendedData encoding="raw">\n_'


def data_arrays(source: str | Path | bytes) -> dict[str, dict[str, np.ndarray]]:
    """The arrays of a field file, or of its content, {section: {name: array}} with the sections Points, PointData, CellData and Cells:
    (n, columns), or (n,) with one column."""
    content = source if isinstance(source, bytes) else Path(source).read_bytes()
    at = content.index(_START)
    order = "<" if b'byte_order="LittleEndian"' in content[:at] else ">"
    base = at + len(_START)

    compressed = b' compressor="vtkZLibDataCompressor"' in content[:at]

    def numbers(count: int, begin: int) -> np.ndarray:
        return np.frombuffer(content, order + "u8", count, begin).astype(int)

    def plain_bytes(begin: int) -> bytes | memoryview:
        if not compressed:
            return memoryview(content)[begin + 8 : begin + 8 + numbers(1, begin)[0]]
        n_pieces = numbers(1, begin)[0]  # then their sizes: of a whole one, of the last one, of each when compressed
        ends = begin + 8 * (3 + n_pieces) + np.cumsum([0, *numbers(3 + n_pieces, begin)[3:]])
        return b"".join(zlib.decompress(content[first:end]) for first, end in zip(ends[:-1], ends[1:]))

    def array(node: ElementTree.Element) -> np.ndarray:
        values = np.frombuffer(plain_bytes(base + int(node.get("offset", "0"))), order + _TYPES[node.get("type", "")])
        columns = int(node.get("NumberOfComponents", 1))
        return values.reshape(-1, columns) if columns > 1 else values

    piece = ElementTree.fromstring(content[:at].decode() + "</VTKFile>").find("UnstructuredGrid/Piece")
    if piece is None:
        raise ValueError("no piece of an unstructured grid in a field file")
    return {section.tag: {node.get("Name", ""): array(node) for node in section} for section in piece}
