"""VTK's XML files (.vtp, .vtu, .vti) as NumPy arrays, and particles as such a file. VTK itself is not needed: its readers end the process on some damaged files.

A file may be damaged in any way, or be made to do harm. So each place, size, type and length in it is compared with the size of the file and with the other numbers before anything is read
or allocated. It reads what VTK, ParaView, meshio and the program write: arrays appended as raw bytes or as base64, or inline as base64 or text; without a compressor, with zlib or LZ4.
Format: VTK file formats, "XML file formats" (docs.vtk.org).
"""

import base64
import binascii
import ctypes
import os
import pathlib
import re
import warnings
import zlib

import numpy

from . import files
from .errors import PackageMissing, Unreadable

TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8", "String": "u1"}
COMPRESSORS = {None: None, "vtkZLibDataCompressor": "zlib", "vtkLZ4DataCompressor": "lz4"}
MOST_OF_A_HEAD = 1 << 22       # bytes before the appended data
MOST_OF_INLINE = 1 << 28       # bytes of a file that has none
MOST_COMPRESSION = 1100        # zlib makes data at most 1032 times smaller, LZ4 255 times
MOST_COMPONENTS = 1 << 16
PADDING = 8192 * b" "          # without it ParaView 5.11 with a later expat does not find the data (src/output/whole_file.hpp)


class Array:
    """One array as the head describes it; `numbers` and `words` of its Document read it."""

    def __init__(self, element):
        said = element.attrib
        self.name, self.type, self.format = said.get("Name"), said.get("type"), said.get("format", "ascii")
        self.components = _whole(said.get("NumberOfComponents", "1"), MOST_COMPONENTS, "NumberOfComponents")
        self.tuples = _whole(said["NumberOfTuples"], 1 << 60, "NumberOfTuples") if "NumberOfTuples" in said else None
        self.offset = _whole(said.get("offset", "0"), 1 << 60, "offset")
        self.text = element.text or ""
        if not self.name:
            raise ValueError("an array has no name")
        if self.type not in TYPES:
            raise ValueError(f'array "{self.name}" is of the type "{self.type}"; expected {", ".join(TYPES)}')
        if self.components < 1:
            raise ValueError(f'array "{self.name}" has no components')


class Document:
    """The head of a file: `kind` ("PolyData"), `about` (attributes of its data set), `piece` (attributes of its one piece), `sections`: arrays by section ("PointData", "Points", ...).

    Throws Unreadable, as `numbers` and `words` do.
    """

    def __init__(self, path, kinds):
        self.path = pathlib.Path(path)
        with files.opened(self.path) as file:
            self._guarded(self._read_head, file, kinds)

    def numbers(self, array, tuples=None):
        """The values of an array of so many tuples, (tuples,) or (tuples, components); without `tuples` of as many as there are."""
        return self._guarded(self._numbers, array, tuples)

    def words(self, array):
        """Texts: those of an array of strings, or the lines of an array of characters."""
        return self._guarded(self._words, array)

    def count(self, name):
        """A whole number that the piece states, such as NumberOfPoints."""
        return self._guarded(lambda: _whole(self.piece.get(name, "0"), 1 << 60, name))

    def check_cells(self, points):
        """Throws Unreadable unless the cells have points of which there are `points`: VTK's readers and filters trust them."""
        for section in ("Verts", "Lines", "Strips", "Polys", "Cells"):
            arrays = self.named(section)
            if not arrays:
                continue
            if not {"connectivity", "offsets"} <= set(arrays):
                self.fail(f"{section} has no connectivity or no offsets")
            ends = self.numbers(arrays["offsets"], self.count("NumberOfCells" if section == "Cells" else f"NumberOf{section}"))
            corners = self.numbers(arrays["connectivity"])
            if corners.dtype.kind not in "iu" or ends.dtype.kind not in "iu" or corners.ndim > 1 or ends.ndim > 1:
                self.fail(f"the cells of {section} are no whole numbers")
            steps = numpy.diff(ends.astype(numpy.int64), prepend=0)
            if (steps < 0).any() or steps.sum() != len(corners) or (len(corners) and not 0 <= corners.min() <= corners.max() < points):
                self.fail(f"the cells of {section} do not fit the points")

    def named(self, section):
        """The arrays of a section by name."""
        return {array.name: array for array in self.sections.get(section, ())}

    def fail(self, why):
        raise Unreadable(f"{self.path}: {why}")

    def _guarded(self, act, *arguments):
        try:
            return act(*arguments)
        except (ValueError, ArithmeticError, OSError, MemoryError, zlib.error, binascii.Error) as error:
            if isinstance(error, Unreadable):
                raise
            raise Unreadable(f"{self.path}: {error or 'there is not enough memory'}: the file is damaged, or is no such file") from error

    # ---- the head

    def _read_head(self, file, kinds):
        self._size = os.fstat(file.fileno()).st_size
        head = file.read(MOST_OF_A_HEAD)
        at = head.find(b"<AppendedData")
        self._data = self._encoding = None
        if at >= 0:
            begin = re.compile(rb'<AppendedData\s+encoding="(raw|base64)"\s*>\s*_').match(head, at)
            if not begin:
                self.fail("its appended data do not begin as those of VTK do")
            self._data, self._encoding = begin.end(), begin[1].decode()
            file.seek(max(self._size - 64, 0))
            end = re.search(rb"\s*</AppendedData>\s*</VTKFile>\s*$", file.read())
            if not end:
                self.fail("it is incomplete: its end is missing")
            self._end = max(self._size - 64, 0) + end.start()
            head = head[:at] + b"</VTKFile>"
        elif self._size > MOST_OF_A_HEAD:
            if self._size > MOST_OF_INLINE:
                self.fail(f"{self._size} bytes without appended data are too many; expected at most {MOST_OF_INLINE}")
            head += file.read()
        root = files.xml(self.path, head.decode())
        self.kind = root.get("type")
        if root.tag != "VTKFile" or self.kind not in kinds:
            self.fail(f"it is no VTK file of {' or '.join(kinds)}")
        self._read_numbers(root)
        data = root.findall(self.kind)
        pieces = data[0].findall("Piece") if len(data) == 1 else []
        if len(pieces) != 1:
            self.fail(f"it has {len(pieces)} pieces; expected 1")
        self.about, self.piece = data[0].attrib, pieces[0].attrib
        self.sections = {}
        for section in [*data[0].findall("FieldData"), *pieces[0]]:
            self.sections.setdefault(section.tag, []).extend(Array(each) for each in section if each.tag in ("DataArray", "Array"))

    def _read_numbers(self, root):
        order, width = root.get("byte_order"), root.get("header_type", "UInt32")
        if order not in ("LittleEndian", "BigEndian") or width not in ("UInt32", "UInt64"):
            self.fail(f'its byte order "{order}" or its header_type "{width}" is not known')
        if root.get("compressor") not in COMPRESSORS:
            self.fail(f'its compressor "{root.get("compressor")}" is not known; expected none, zlib or LZ4')
        self._order = "<" if order == "LittleEndian" else ">"
        self._head = numpy.dtype(self._order + TYPES[width])
        self._compressor = COMPRESSORS[root.get("compressor")]

    # ---- values

    def _numbers(self, array, tuples):
        if array.type == "String":
            raise ValueError(f'array "{array.name}" holds texts; expected numbers')
        if tuples is not None and array.tuples not in (None, tuples):
            raise ValueError(f'array "{array.name}" has {array.tuples} tuples; expected {tuples}')
        values = self._values(array, None if tuples is None else tuples * array.components)
        tuples = len(values) // array.components if tuples is None else tuples
        count = tuples * array.components
        if len(values) != count:
            raise ValueError(f'array "{array.name}" has {len(values)} numbers; expected {count}')
        return values.reshape(tuples, array.components) if array.components > 1 else values

    def _words(self, array):
        characters = self._values(array, None)
        text = characters.astype(numpy.uint8).tobytes().decode(errors="replace")
        if array.type != "String":
            return text.split("\n") if text else []
        lines = text.split("\0")
        if lines.pop() or array.tuples not in (None, len(lines)):
            raise ValueError(f'array "{array.name}" is incomplete')
        return lines

    def _values(self, array, count):
        """All numbers of an array. `count`: how many they should be, None if nobody knows."""
        kind = numpy.dtype(self._order + TYPES[array.type])
        if array.format == "ascii":
            return _printed(array, kind.newbyteorder("="))
        content = self._bytes(array, None if count is None else count * kind.itemsize)
        if len(content) % kind.itemsize:
            raise ValueError(f'array "{array.name}" is incomplete')
        values = content.view(kind)
        return values if kind.isnative else values.astype(kind.newbyteorder("="))

    def _bytes(self, array, expected):
        """The bytes of an array as VTK would have them in memory."""
        if array.format == "binary":
            return self._expanded(array, _Bytes(_decoded(array.text)), expected)
        if array.format != "appended" or self._data is None:
            raise ValueError(f'array "{array.name}" has the format "{array.format}"; expected "appended", "binary" or "ascii"')
        begin = self._data + array.offset
        if begin > self._end:
            raise ValueError(f'array "{array.name}" lies behind the end of the file')
        with files.opened(self.path) as file:
            if self._encoding == "raw":
                return self._expanded(array, _Stretch(file, begin, self._end), expected)
            if self._end - begin > MOST_OF_INLINE:
                raise ValueError("its appended text is too long")
            file.seek(begin)
            return self._expanded(array, _Bytes(_decoded(file.read(self._next(array.offset) - array.offset).decode("ascii"))), expected)

    def _next(self, offset):
        """Where the array behind that of this offset begins, or the data end."""
        offsets = [array.offset for arrays in self.sections.values() for array in arrays if array.offset > offset]
        return min([*offsets, self._end - self._data])

    def _expanded(self, array, source, expected):
        if self._compressor is None:
            size = int(source.numbers(1, self._head)[0])
            self._check_size(array, size, expected, source.left())
            return source.array(size)
        blocks, each, last = map(int, source.numbers(3, self._head))
        if blocks > source.left() // self._head.itemsize or last >= max(each, 1):
            raise ValueError(f'array "{array.name}" is incomplete')
        sizes = source.numbers(blocks, self._head).tolist()
        total = (blocks - 1) * each + (last or each) if blocks else 0
        if sum(sizes) > source.left():
            raise ValueError(f'array "{array.name}" is incomplete')
        self._check_size(array, total, expected, MOST_COMPRESSION * sum(sizes))
        packed, out, at = source.array(sum(sizes)), numpy.empty(total, numpy.uint8), 0
        expand = _expand_zlib if self._compressor == "zlib" else _expand_lz4
        for k, size in enumerate(sizes):
            piece = out[k * each:min((k + 1) * each, total)]
            if not expand(packed[at:at + size], piece):
                raise ValueError(f'array "{array.name}" is damaged')
            at += size
        return out

    def _check_size(self, array, size, expected, most):
        if size > most or (expected is not None and size != expected):
            raise ValueError(f'array "{array.name}" has {size} bytes' + (f"; expected {expected}" if expected is not None else ""))
        if size > files.memory():
            raise ValueError(f'array "{array.name}" has {size} bytes, more than there is memory')


class _Stretch:
    """Bytes of an open file from a place to another, read from the front."""

    def __init__(self, file, begin, end):
        self._file, self._at, self._end = file, begin, end
        file.seek(begin)

    def left(self):
        return self._end - self._at

    def array(self, size):
        if size > self.left():
            raise ValueError("an array is incomplete")
        values = numpy.empty(size, numpy.uint8)
        if size and self._file.readinto(memoryview(values)) != size:
            raise ValueError("the file ended while it was read")
        self._at += size
        return values

    def numbers(self, count, kind):
        return self.array(count * kind.itemsize).view(kind)


class _Bytes(_Stretch):
    """The same of bytes in memory."""

    def __init__(self, content):
        self._content, self._at, self._end = content, 0, len(content)

    def array(self, size):
        if size > self.left():
            raise ValueError("an array is incomplete")
        self._at += size
        return numpy.frombuffer(self._content, numpy.uint8, size, self._at - size).copy()


def _whole(text, most, name):
    """A whole number from 0 to `most`."""
    if not re.fullmatch(r"\s*[0-9]{1,20}\s*", text) or int(text) > most:
        raise ValueError(f'{name}="{text[:40]}" is no whole number from 0 to {most}')
    return int(text)


def _printed(array, kind):
    """The numbers of a text."""
    wide = numpy.dtype(float if kind.kind == "f" else "u8" if kind == "u8" else "i8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            values = numpy.fromstring(array.text, wide, sep=" ")
        except Warning as error:  # NumPy only warns of a text that it cannot read to its end
            raise ValueError(f'array "{array.name}": {error}') from error
    if kind.kind != "f" and len(values) and not numpy.iinfo(kind).min <= values.min() <= values.max() <= numpy.iinfo(kind).max:
        raise ValueError(f'array "{array.name}" holds a number that {array.type} cannot hold')
    return values.astype(kind)


def _decoded(text):
    """The bytes of base64; an array has one text or several, each with its own end."""
    return b"".join(base64.b64decode(part, validate=True) for part in re.findall(r"[^=]+={0,2}", "".join(text.split())))


def _expand_zlib(block, out):
    """Whether the block holds exactly as many bytes as `out`, which gets them."""
    stream = zlib.decompressobj()
    found = stream.decompress(block.tobytes(), len(out) + 1)
    if len(found) != len(out) or not stream.eof:
        return False
    out[:] = numpy.frombuffer(found, numpy.uint8)
    return True


def _expand_lz4(block, out):
    """The same; LZ4_decompress_safe writes and reads nowhere else, whatever the block holds."""
    return _lz4()(block.ctypes.data, out.ctypes.data, len(block), len(out)) == len(out)


def _lz4():
    if not hasattr(_lz4, "expand"):
        try:
            library = ctypes.CDLL("liblz4.dylib" if os.uname().sysname == "Darwin" else "liblz4.so.1")
        except OSError as error:
            raise PackageMissing(f"this frame is compressed with LZ4, whose library is not installed ({error}): apt install liblz4-1; or run with output.format = \"vtu\"") from error
        _lz4.expand = library.LZ4_decompress_safe
        _lz4.expand.argtypes, _lz4.expand.restype = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int], ctypes.c_int
    return _lz4.expand


# ---- writing ---------------------------------------------------------------------------------------------------------------------------------------------------------------

class _Writer:
    """Elements of a file and the bytes of its arrays, each behind its length, uncompressed."""

    def __init__(self):
        self.lines, self.data, self.size = [], [], 0

    def array(self, name, values):
        values = numpy.ascontiguousarray(values)
        values = values.astype(numpy.uint8) if values.dtype == bool else values
        kind = next((word for word, code in TYPES.items() if values.dtype == numpy.dtype(code)), None)
        if kind is None:
            raise TypeError(f"{name}: VTK has no array of {values.dtype}")
        components = values.shape[1] if values.ndim > 1 else 1
        self.lines.append(f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{self.size}"/>')
        self._add(values.astype(values.dtype.newbyteorder("<")).tobytes())

    def words(self, name, words):
        self.lines.append(f'<Array type="String" Name="{name}" NumberOfTuples="{len(words)}" format="appended" offset="{self.size}"/>')
        self._add(b"".join(word.encode() + b"\0" for word in words))

    def _add(self, content):
        self.data += [len(content).to_bytes(8, "little"), content]
        self.size += 8 + len(content)


def write_particles(path, x, arrays, words):
    """Writes a .vtp of particles at x (n, 3) with `arrays` (n,) or (n, components) by name, and with `words`, lists of texts by name. Throws OSError, TypeError."""
    n, out = len(x), _Writer()
    out.lines += ["<PolyData>", "<FieldData>"]
    for name, texts in words.items():
        out.words(name, texts)
    out.lines += ["</FieldData>", f'<Piece NumberOfPoints="{n}" NumberOfVerts="{n}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">', "<PointData>"]
    for name, values in arrays.items():
        out.array(name, values)
    out.lines += ["</PointData>", "<Points>"]
    out.array("Points", numpy.asarray(x, float))
    out.lines += ["</Points>", "<Verts>"]
    out.array("connectivity", numpy.arange(n, dtype=numpy.int64))
    out.array("offsets", numpy.arange(1, n + 1, dtype=numpy.int64))
    out.lines += ["</Verts>", "</Piece>", "</PolyData>"]
    head = '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n' + "\n".join(out.lines)
    pathlib.Path(path).write_bytes(head.encode() + b'\n<AppendedData encoding="raw">\n' + PADDING + b"_" + b"".join(out.data) + b"\n</AppendedData>\n</VTKFile>\n")
