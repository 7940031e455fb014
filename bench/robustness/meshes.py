#!/usr/bin/python3
"""Damaged files of shapes: .stl and .ply (text and binary), .obj, .vtp, .vtu, .vtk (text and binary) and .csv.

    meshes.py PROGRAM [--files 2000] [--seed 1]

A ball (in .csv a star) in each form is damaged: cut, a bit or bytes changed, words exchanged, numbers of the text made wrong. `barchan generate` must
refuse the file with status 2, or fill what the file says: then an independent reader (meshio, of .csv this script) reads the damaged file, its triangles are
written as a clean file, and both must give the same particles. No file may take more than two seconds of user CPU, 30 of wall time, or end the program by a signal. Prints a line for
each failure and the figures as JSON; status 1 on failures.
"""
import argparse
import collections
import json
import math
import pathlib
import random
import re
import shutil
import sys
import tempfile

import meshio
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import frame, run  # noqa: E402

LIMIT = 2.0  # s of user CPU, which other work on the machine does not lengthen
SCENE = """dimensions = {dimensions}
spacing = 0.1
[domain]
size = [{size}]
[phases.air]
kind = "fluid"
density = 1
sound-speed = 10
[interactions]
air-air = 2.1
[[fill]]
phase = "air"
shape = {{ surface = "{file}" }}
[time]
end = 1
"""


def ball(rows=6, radius=0.8):
    """Points and triangles of a ball about (1, 1, 1)."""
    points = [(1, 1, 1 + radius)]
    for j in range(1, rows):
        for i in range(2 * rows):
            a, b = math.pi * j / rows, math.pi * i / rows
            points.append((1 + radius * math.sin(a) * math.cos(b), 1 + radius * math.sin(a) * math.sin(b), 1 + radius * math.cos(a)))
    points.append((1, 1, 1 - radius))
    around, last = 2 * rows, len(points) - 1
    ring = lambda j, i: 1 + (j - 1) * around + i % around
    triangles = []
    for i in range(around):
        triangles += [(0, ring(1, i), ring(1, i + 1)), (last, ring(rows - 1, i + 1), ring(rows - 1, i))]
        for j in range(1, rows - 1):
            triangles += [(ring(j, i), ring(j + 1, i), ring(j + 1, i + 1)), (ring(j, i), ring(j + 1, i + 1), ring(j, i + 1))]
    return numpy.array(points), numpy.array(triangles)


def vtk_files(top, points, triangles):
    """What meshio does not write: .vtp, and .vtk of both forms as VTK writes them."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    data, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    for p in points:
        places.InsertNextPoint(p)
    for t in triangles:
        cells.InsertNextCell(3, [int(k) for k in t])
    data.SetPoints(places)
    data.SetPolys(cells)
    for name, mode in (("ascii.vtp", "SetDataModeToAscii"), ("binary.vtp", "SetDataModeToBinary"), ("appended.vtp", "SetDataModeToAppended")):
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(top / name))
        writer.SetInputData(data)
        getattr(writer, mode)()
        writer.Write()
    for name, kind in (("ascii.vtk", 1), ("binary.vtk", 2)):
        writer = vtkPolyDataWriter()
        writer.SetFileName(str(top / name))
        writer.SetInputData(data)
        writer.SetFileType(kind)
        writer.Write()


def whole_files(top):
    points, triangles = ball()
    mesh = meshio.Mesh(points, [("triangle", triangles)])
    for name, options in (("ascii.stl", {"binary": False}), ("binary.stl", {"binary": True}), ("ascii.ply", {"binary": False}), ("binary.ply", {"binary": True}),
                          ("text.obj", {}), ("text.vtu", {"binary": False}), ("binary.vtu", {"binary": True})):
        mesh.write(top / name, **options)
    vtk_files(top, points, triangles)
    star = [(1 + r * math.cos(a), 1 + r * math.sin(a)) for r, a in ((0.5 + 0.3 * (k % 2), math.pi * k / 8) for k in range(16))]
    (top / "corners.csv").write_text("x,y\n" + "".join(f"{x:.6f},{y:.6f}\n" for x, y in star))
    return sorted(f for f in top.iterdir())


def damage(content, chance):
    """The bytes of a file, damaged; and what was done."""
    kind = chance.choice(["cut", "bit", "bytes", "number", "word", "line"])
    at = chance.randrange(len(content))
    changed = bytearray(content)
    if kind == "cut":
        return bytes(content[:at]), kind
    if kind == "bit":
        changed[at] ^= 1 << chance.randrange(8)
    elif kind == "bytes":
        for k in range(at, min(at + chance.randrange(1, 32), len(changed))):
            changed[k] = chance.randrange(256)
    elif kind == "line":
        lines = content.split(b"\n")
        del lines[chance.randrange(len(lines))]
        return b"\n".join(lines), kind
    else:
        found = list(re.finditer(rb"[-0-9.e]+" if kind == "number" else rb"[A-Za-z_]+", content[:4000] if chance.random() < 0.5 else content))
        hit = chance.choice(found)
        new = chance.choice([b"0", b"-1", b"7", b"4294967296", b"99999999999999999999", b"", b"zz", b"inf", b"nan", b"1e9", b"0.5", b"x"])
        return content[:hit.start()] + new + content[hit.end():], kind
    return bytes(changed), kind


def corners(file):
    """Segments of a .csv of polygons; None: it is malformed."""
    polygons, rows = [[]], file.read_bytes().decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    number = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
    first = True
    for row in rows:
        words = re.split(r"[ \t\f\v,;]+", row.strip(" \t\f\v,;"))
        if words == [""]:
            polygons.append([])
            continue
        if words[0].startswith("#"):
            continue
        if len(words) == 2 and all(number.fullmatch(w) for w in words):
            polygons[-1].append((float(words[0]), float(words[1])))
        elif not (first and len(words) == 2 and not number.fullmatch(words[0])):
            return None
        first = False
    return polygons


class Damager:
    def __init__(self, program, seed):
        self.program, self.chance = program, random.Random(seed)
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="barchan_meshes_"))
        self.count, self.failures, self.longest = collections.Counter(), [], 0.0

    def fail(self, what):
        self.failures.append(what)
        print("FAILED:", what, flush=True)

    def particles(self, file):
        """Status, and the bytes of the places that the program fills."""
        flat = file.suffix == ".csv"
        scene, out = self.top / "scene.toml", self.top / "out.vtu"
        scene.write_text(SCENE.format(dimensions=2 if flat else 3, size="2, 2" if flat else "2, 2, 2", file=file))
        out.unlink(missing_ok=True)
        done = run.generate(self.program, scene, out, timeout=30)
        self.seconds = done.user
        self.longest = max(self.longest, self.seconds)
        if done.status != 0:
            return -99 if done.status is None else done.status, None
        return 0, frame.Frame(out).x.tobytes()

    def as_read_by_another(self, file):
        """A clean file with what an independent reader finds in the damaged one; None: it refuses."""
        clean = self.top / "clean.obj"
        try:
            if file.suffix == ".csv":
                polygons = corners(file)
                if polygons is None:
                    return None
                clean = self.top / "clean.csv"
                clean.write_text("\n".join("".join(f"{x!r},{y!r}\n" for x, y in p) for p in polygons))
                return clean
            if file.suffix in (".vtp", ".vtk"):  # meshio reads no .vtp, and of .vtk no polygons
                points, faces = self.by_vtk(file)
            else:
                if file.suffix == ".obj":  # meshio reads no points with a weight or a colour
                    plain = self.top / "plain.obj"
                    plain.write_bytes(re.sub(rb"(?m)^(v(?:[ \t]+\S+){3})[ \t].*$", rb"\1", file.read_bytes()))
                    file = plain
                mesh = meshio.read(file)
                points = mesh.points
                faces = [row for block in mesh.cells if block.type in ("triangle", "quad", "polygon") for row in block.data]
            clean.write_text("".join("v {!r} {!r} {!r}\n".format(*map(float, p)) for p in points) + "".join("f " + " ".join(str(int(k) + 1) for k in f) + "\n" for f in faces))
            return clean
        except BaseException as error:  # meshio ends the program of who asks for a malformed file
            if isinstance(error, KeyboardInterrupt):
                raise
            return None

    def by_vtk(self, file):
        code = f"""
import json, sys
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkIOLegacy import vtkPolyDataReader
r = vtkXMLPolyDataReader() if {file.suffix == '.vtp'} else vtkPolyDataReader()
r.SetFileName({str(file)!r}); r.Update(); d = r.GetOutput()
n = d.GetNumberOfPoints()
faces = []
for k in range(d.GetNumberOfCells()):
    ids = d.GetCell(k).GetPointIds()
    faces.append([ids.GetId(i) for i in range(ids.GetNumberOfIds())])
    assert all(0 <= i < n for i in faces[-1])
print(json.dumps([[d.GetPoint(i) for i in range(n)], faces]))
"""
        done = run.command([sys.executable, "-c", code], timeout=60)
        if done.status != 0:
            raise ValueError
        return json.loads(done.stdout)

    def one(self, number, file):
        content, kind = damage(file.read_bytes(), self.chance)
        damaged = self.top / ("damaged" + file.suffix)
        damaged.write_bytes(content)
        status, found = self.particles(damaged)
        what = f"{file.name} {number} ({kind})"
        self.count[f"{file.suffix}: status {status}"] += 1
        if status not in (0, 2):
            self.fail(f"{what}: status {status}")
        if self.seconds > LIMIT:
            self.fail(f"{what}: {self.seconds:.2f} s")
        if status != 0:
            return
        clean = self.as_read_by_another(damaged)
        if clean is None:
            if found != self.whole[file]:  # meshio refuses some files that are whole, and so is the shape
                self.fail(f"{what}: another shape, and the independent reader refuses the file")
            self.count["refused by the independent reader, the whole shape"] += found == self.whole[file]
            return
        if self.particles(clean)[1] != found:
            self.fail(f"{what}: another shape than the independent reader's")

    def main(self, files):
        whole = self.top / "whole"
        whole.mkdir()
        names = whole_files(whole)
        self.whole = {}
        for file in names:
            status, self.whole[file] = self.particles(file)
            if status:
                self.fail(f"{file.name}: the whole file: status {status}")
        for number in range(files):
            self.one(number, names[number % len(names)])
        print(json.dumps({"files": files, "forms": len(names), "failures": len(self.failures), "longest s": round(self.longest, 2), **dict(sorted(self.count.items()))}, indent=2))
        shutil.rmtree(self.top, ignore_errors=True)
        return 1 if self.failures else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    sys.exit(Damager(options.program, options.seed).main(options.files))
