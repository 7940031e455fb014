"""The series that a state shows: its reader in ParaView, its phases, and the ranges of its values over a few frames.

Colours and view must hold for all frames of a film, and one particle that went astray must not decide them. So:

- statistics are taken over up to nine frames across the series;
- the view is the box of the particles inside the domain (array `domain` of the frame's field data) and of the walls
  around it. A series without that array has its box without outliers, see `within_reach`;
- ranges of colours are percentiles of the particles inside that box.
"""

import glob
import json
import os
import sys

import numpy as np
from paraview import servermanager
from paraview.simple import (Calculator, Clip, PVDReader, Threshold, XMLPartitionedPolydataReader, XMLPartitionedUnstructuredGridReader,
                             XMLPolyDataReader, XMLUnstructuredGridReader)
from vtkmodules.util.numpy_support import vtk_to_numpy

from barchan_numbers import nice_ceiling, percentile, within_reach

SAMPLES = 9                         # frames from which ranges are taken

KIND_BY_NAME = {
    "fluid": ("air", "gas", "wind", "water", "oil", "fluid", "liquid", "lubricant", "left-gas"),
    "grains": ("sand", "grain", "dust", "snow", "gravel"),
    "wall": ("wall", "ground", "boundary", "ghost", "bottom", "floor", "plate-fixed"),
}


class Wrong(Exception):
    """The command or the file is wrong; the message says what. pvstate/render shows it alone and ends with status 2."""


def find_series(state_file):
    """The file to show. Raises Wrong with what was tried."""
    chosen = os.environ.get("BARCHAN_SERIES")
    if not chosen and "--series" in sys.argv[:-1]:
        chosen = sys.argv[sys.argv.index("--series") + 1]
    if chosen:
        if not os.path.isfile(chosen):
            raise Wrong(f"there is no series '{chosen}'")
        return os.path.abspath(chosen)
    places = [os.getcwd(), os.path.dirname(os.path.dirname(os.path.abspath(state_file)))]
    found = [path for place in places for path in glob.glob(os.path.join(place, "out", "*", "*.pvd"))]
    if not found:
        raise Wrong("no series: set BARCHAN_SERIES to a .pvd, or run a scene first (looked for out/*/*.pvd in "
                    + " and ".join(places) + ")")
    return os.path.abspath(max(found, key=os.path.getmtime))


def open_reader(path, name):
    """The reader of a series (.pvd) or of a single frame (.vtp, .vtu; in pieces .pvtp, .pvtu)."""
    ending = os.path.splitext(path)[1]
    if ending == ".pvd":
        return PVDReader(registrationName=name, FileName=path)
    if ending == ".vtp":
        return XMLPolyDataReader(registrationName=name, FileName=[path])
    if ending == ".vtu":
        return XMLUnstructuredGridReader(registrationName=name, FileName=[path])
    if ending == ".pvtp":
        return XMLPartitionedPolydataReader(registrationName=name, FileName=[path])
    if ending == ".pvtu":
        return XMLPartitionedUnstructuredGridReader(registrationName=name, FileName=[path])
    raise Wrong(f"{path}: expected a series (.pvd) or a frame (.vtp, .vtu; in pieces .pvtp, .pvtu)")


def kind_of(name):
    """The kind of a phase by its name, for a series that does not say it."""
    for kind, words in KIND_BY_NAME.items():
        if any(word in name.lower() for word in words):
            return kind
    return "elastic"


# ---- the series --------------------------------------------------------------------------------------------------------

def fetch(reader, time, path, arrays=()):
    """The arrays of one frame by name: points, id, phase, velocity, smoothing_length, those of `arrays` that are there, and what its field data say."""
    reader.UpdatePipeline(time)
    data = servermanager.Fetch(reader)
    if data is None or not data.GetNumberOfPoints():
        raise Wrong(f"no particles in {path} at time {time:g} s")
    sample = {"points": vtk_to_numpy(data.GetPoints().GetData()).astype(float)}
    for name in ("id", "phase", "velocity", "smoothing_length", *arrays):
        array = data.GetPointData().GetArray(name)
        if array is not None:
            sample[name] = vtk_to_numpy(array).copy()
    for name in ("phase", "velocity"):
        if name not in sample:
            raise Wrong(f"{path} has no point array '{name}': is it a series of Barchan?")
    about = data.GetFieldData()
    for name in ("phase_names", "phase_kinds"):
        sample[name] = lines_of(about.GetAbstractArray(name))
    domain = about.GetArray("domain")
    if domain is not None and domain.GetNumberOfValues() == 6:
        sample["domain"] = np.array([domain.GetValue(k) for k in range(6)])
    sane = np.isfinite(sample["points"]).all(axis=1) & np.isfinite(sample["velocity"]).all(axis=1)
    for name in ("points", "id", "phase", "velocity", "smoothing_length", *arrays):
        if name in sample:
            sample[name] = sample[name][sane]
    return sample


def lines_of(array):
    """Lines of text in field data: strings (.vtp), or bytes with a newline between lines (.vtu)."""
    if array is None:
        return []
    if array.IsA("vtkStringArray"):
        return [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array).astype(np.uint8).tobytes().decode().split("\n")


class Series:
    """A series opened in ParaView: its reader, times, phases, spacing (m) and bounds (m). `arrays`: names of point arrays that values() gives
    beside those that every frame has; one that no frame has is left out."""

    def __init__(self, path, arrays=()):
        self.path = path
        self._arrays = tuple(dict.fromkeys((*arrays, "radius")))
        self._distances = {}            # m, by phase
        self.name = os.path.splitext(os.path.basename(path))[0]
        self.reader = open_reader(path, self.name)
        self.times = [float(t) for t in np.atleast_1d(self.reader.TimestepValues)] or [0.0]
        self.hidden = {name.strip() for name in os.environ.get("BARCHAN_HIDE", "").split(",")} - {""}

        chosen = sorted({round(k) for k in np.linspace(0, len(self.times) - 1, SAMPLES)})
        self._samples = [fetch(self.reader, self.times[k], path, self._arrays) for k in chosen]
        first = self._samples[0]
        self.phase_names = first["phase_names"] or ["phase"]
        kinds = first["phase_kinds"]
        self.phase_kinds = kinds if len(kinds) == len(self.phase_names) else [kind_of(name) for name in self.phase_names]
        unknown = self.hidden - set(self.phase_names)
        if unknown:
            raise Wrong(f"no phase '{unknown.pop()}' to hide in {path}; it has " + ", ".join(self.phase_names))
        self.two_dimensional = not any(s["points"][:, 2].any() for s in self._samples)
        self.spacing = self._find_spacing(first)
        self.domain = first.get("domain")
        for sample in self._samples:
            self._leave_out_strays(sample)
        self.has_grains = "grains" in self.phase_kinds
        self.up = self._find_up()
        self._helpers = self._helper_walls()
        self._thresholds = {}
        self.window = None              # [x0, x1, y0, y1, z0, z1] in metres: only these particles are drawn
        self.title = self._from_run("title") or self.name.replace("_", " ").replace("-", " ").capitalize()

    def _leave_out_strays(self, sample):
        """Drops from a sample what decides neither view nor colours: particles that left the domain."""
        points = sample["points"]
        wall = np.isin(sample["phase"], [k for k, kind in enumerate(self.phase_kinds) if kind == "wall"])
        keep = np.zeros(len(points), dtype=bool)
        keep[wall] = within_reach(points[wall], self.spacing)   # walls stand outside the domain
        if self.domain is not None:
            low, high = self.domain[0::2] - self.spacing, self.domain[1::2] + self.spacing
            keep[~wall] = ((points[~wall] >= low) & (points[~wall] <= high)).all(axis=1)
        else:
            keep[~wall] = within_reach(points[~wall], self.spacing)
        for name in ("points", "id", "phase", "velocity", "smoothing_length", *self._arrays):
            if name in sample:
                sample[name] = sample[name][keep]

    def _find_spacing(self, sample):
        """What run.json says, else the median distance to the nearest neighbour in the most regular phase."""
        said = self._from_run("spacing")
        if isinstance(said, (int, float)) and said > 0:
            return float(said)
        medians = []
        for phase in np.unique(sample["phase"]):
            points = sample["points"][sample["phase"] == phase]
            if len(points) < 2:
                continue
            nearest = []
            for probe in points[np.linspace(0, len(points) - 1, min(len(points), 100)).astype(int)]:
                squares = ((points - probe) ** 2).sum(axis=1)
                squares[squares == 0] = np.inf
                nearest.append(squares.min())
            medians.append(float(np.sqrt(np.median(nearest))))
        if not medians:
            return float(sample.get("smoothing_length", [1.0])[0])
        # A perturbed phase gives less than its spacing, a few lone particles give far more.
        return max(m for m in medians if m < 1.5 * min(medians))

    def _from_run(self, key):
        """What the run's run.json says of its scene (title, spacing), None when it does not."""
        try:
            with open(os.path.join(os.path.dirname(self.path), "run.json"), encoding="utf-8") as file:
                return json.load(file)["scene"].get(key)
        except (OSError, ValueError, LookupError, TypeError, AttributeError):
            return None

    def _find_up(self):
        """The axis against gravity, "y" or "z", as run.json says; y where it says nothing."""
        gravity = self._from_run("gravity")
        numbers = gravity if isinstance(gravity, list) and len(gravity) == 3 and all(isinstance(g, (int, float)) for g in gravity) else [0, 0, 0]
        return "z" if abs(numbers[2]) > max(abs(numbers[0]), abs(numbers[1])) else "y"

    def _helper_walls(self):
        """Walls in which grains stand at the start: they are those of another phase, as the ground of the air in which sand lies, and are not drawn."""
        first, helpers = self._samples[0], set()
        grains = first["points"][np.isin(first["phase"], [k for k, kind in enumerate(self.phase_kinds) if kind == "grains"])]
        for phase in [k for k, kind in enumerate(self.phase_kinds) if kind == "wall"]:
            wall = first["points"][first["phase"] == phase]
            if not len(grains) or not len(wall):
                continue
            width = self._distance(phase)
            probes = grains[np.linspace(0, len(grains) - 1, min(len(grains), 400)).astype(int)]
            wall = wall[((wall >= probes.min(axis=0) - width) & (wall <= probes.max(axis=0) + width)).all(axis=1)]
            inside = [len(wall) and ((wall - probe) ** 2).sum(axis=1).min() < (0.48 * width) ** 2 for probe in probes]
            if np.mean(inside) > 0.2:
                helpers.add(phase)
        return helpers

    # -- phases

    def phases(self, *kinds):
        """Numbers of the phases of these kinds that are there and not hidden; walls in which grains stand are left out."""
        return [k for k, (name, kind) in enumerate(zip(self.phase_names, self.phase_kinds))
                if kind in kinds and name not in self.hidden and k not in self._helpers]

    def names_of(self, phases):
        """The names of phases in a title."""
        return " and ".join(self.phase_names[k].replace("_", " ") for k in phases)

    def speed_title(self, phases):
        """The title of a colour bar: whose speed it is, by name and kind; of more than three phases without names."""
        names = self.names_of(phases) if len(phases) <= 3 else "all that moves"
        kinds = " and ".join(dict.fromkeys(self.phase_kinds[k] for k in phases)) if len(phases) <= 3 else ""
        return f"speed of {names}" + (f" ({kinds})" if kinds and kinds not in names else "") + ", m/s"

    def source(self, phase):
        """The particles of one phase inside the window, as a filter of the pipeline."""
        if phase not in self._thresholds:
            part = Threshold(registrationName=self.phase_names[phase], Input=self.reader)
            part.Scalars = ["POINTS", "phase"]
            part.LowerThreshold, part.UpperThreshold = phase - 0.5, phase + 0.5
            if self.window is not None:   # what lies outside must not be drawn over the title and the axes
                part = self.cut(part, self.phase_names[phase] + " in the window", exact=False)
            self._thresholds[phase] = part
        return self._thresholds[phase]

    def cut(self, source, name, exact):
        """What of a source lies in the window; `exact` cuts a cell in two, otherwise whole cells count."""
        x0, x1, y0, y1, z0, z1 = self.window
        margin = 100 * self.spacing if self.two_dimensional else 0.0   # pictures of 2D scenes have layers along z
        box = Clip(registrationName=name, Input=source, ClipType="Box")
        box.ClipType.Position = [x0, y0, z0 - margin]
        box.ClipType.Length = [x1 - x0, y1 - y0, z1 - z0 + 2 * margin]
        box.Invert, box.Exact = 1, int(exact)
        return box

    def calculated(self, source, name, function):
        """The source with one more array of the points, for example `1000*smoothing_length`."""
        calculator = Calculator(registrationName=name, Input=source)
        calculator.ResultArrayName = name
        calculator.Function = function
        return calculator

    # -- statistics over a few frames of the series, so that colours and camera hold still in a film

    def first(self):
        """The arrays of the first frame by name: points, id, phase, velocity, smoothing_length."""
        return self._samples[0]

    def values(self, name, phases):
        """One array of point data of these phases, of all sampled frames together."""
        parts = [s[name][np.isin(s["phase"], phases)] for s in self._samples if name in s]
        return np.concatenate(parts) if parts else np.zeros(0)

    def has(self, name):
        """Whether the frames have this point array (one of those that the state asked for)."""
        return any(name in sample for sample in self._samples)

    def need(self, *names):
        """The first of these point arrays that the frames have. Raises Wrong, which says how a scene gets them."""
        for name in names:
            if self.has(name):
                return name
        words = " nor ".join(f"'{name}'" for name in names)
        raise Wrong(f"{self.path} has no point array {words}: name {'one of them' if len(names) > 1 else 'it'} in the scene's output.fields, for "
                    f"example --set 'output.fields=[\"{names[0]}\"]'")

    def range_of(self, values):
        """The range of colours of these values, and whether it is signed. With values below zero it is symmetric about zero; else it begins at zero,
        or at the lowest value if that is above half of the highest."""
        low, high = percentile(values, 0.5), percentile(values, 99.5)
        if low < -0.05 * max(high, 0.0):
            top = nice_ceiling(max(-low, high))
            return -top, top, True
        if high <= 0:
            return 0.0, 1.0, False
        return (low, high, False) if low > 0.5 * high else (0.0, nice_ceiling(high), False)

    def file_of(self, kind, ending):
        """The files KIND_NAME.ENDING beside the series that an instrument of the scene wrote, in the order of their names. Raises Wrong if there is none."""
        files = sorted(glob.glob(os.path.join(os.path.dirname(self.path), f"{kind}_*.{ending}")))
        if not files:
            raise Wrong(f"{os.path.dirname(self.path)} has no {kind}_*.{ending}: the scene needs [[{kind.replace('_', '-')}]]")
        return files

    def ways(self, phases, number, frames=240):
        """Ways of the `number` particles of these phases that go farthest, from up to `frames` frames: for each a list of places (m), and the speeds
        (m/s) there. A way parts where a particle jumps by more than half of the domain: a periodic side. Particles that are not there from the
        first frame on, or leave, have the part that the frames show."""
        chosen = sorted({round(k) for k in np.linspace(0, len(self.times) - 1, frames)})
        tracks = {}
        for k in chosen:
            frame = fetch(self.reader, self.times[k], self.path)
            here = np.isin(frame["phase"], phases)
            for name, place, speed in zip(frame["id"][here], frame["points"][here], np.linalg.norm(frame["velocity"][here], axis=1)):
                tracks.setdefault(int(name), []).append((k, place, speed))
        size = self.domain[1::2] - self.domain[0::2] if self.domain is not None else np.full(3, np.inf)
        size = np.where(size > 0, size, np.inf)
        parts = []
        for track in tracks.values():
            places = np.array([place for _, place, _ in track])
            steps = np.diff(places, axis=0)
            jumps = (np.abs(steps) > 0.5 * size).any(axis=1)
            far = np.linalg.norm(steps[~jumps], axis=1).sum() if len(steps) else 0.0
            parts.append((far, places, [speed for *_, speed in track], np.flatnonzero(jumps) + 1))
        parts.sort(key=lambda part: -part[0])
        ways, speeds = [], []
        for _, places, fast, cuts in parts[:number]:
            for begin, end in zip([0, *cuts], [*cuts, len(places)]):
                if end - begin > 1:
                    ways.append(places[begin:end])
                    speeds.append(fast[begin:end])
        if not ways:
            raise Wrong(f"{self.path}: no particle of {self.names_of(phases)} is in two frames")
        return ways, speeds

    def speeds(self, phases):
        """Speeds (m/s) of the particles of these phases, of all sampled frames together."""
        velocity = self.values("velocity", phases)
        return np.linalg.norm(velocity, axis=1) if len(velocity) else np.zeros(0)

    def size(self, phase):
        """The spacing (m) of a phase; of grains their diameter: of the largest as the particles' radius says, else the spacing, or where they have another
        size the diameter in their smoothing length (a smoothing length of grains is the largest radius)."""
        if self.phase_kinds[phase] != "grains":
            return self.spacing
        known = self.values("radius", [phase]) if self.has("radius") else np.zeros(0)
        if (known > 0).any():
            return float(2 * known.max())
        r = self.values("smoothing_length", [phase])
        r = r[r > 0]
        return float(2 * r.max()) if len(r) and abs(2 * r.max() / self.spacing - 1) > 0.25 else self.spacing

    def _distance(self, phase):
        """Of the particles of a phase at the start from their three nearest ones, the median of the means (m): its spacing, on a lattice or not."""
        if phase not in self._distances:
            self._distances[phase] = self._measured_distance(phase)
        return self._distances[phase]

    def _measured_distance(self, phase):
        points = self._samples[0]["points"][self._samples[0]["phase"] == phase]
        if len(points) < 4:
            return self.size(phase)
        squares = (((points - probe) ** 2).sum(axis=1) for probe in points[np.linspace(0, len(points) - 1, min(len(points), 200)).astype(int)])
        return float(np.median([np.sqrt(np.sort(np.partition(s, 3)[:4])[1:]).mean() for s in squares]))

    def ring(self, phase):
        """(x, y, inner radius, outer radius) in metres of a wall of a 2D scene that is a closed ring and stays where it is, else None."""
        rings = []
        for sample in self._samples:
            points = sample["points"][sample["phase"] == phase][:, :2]
            if len(points) < 24:
                return None
            middle, spacing = points.mean(axis=0), self._distance(phase)
            radius, angle = np.hypot(*(points - middle).T), np.arctan2(*(points - middle).T)
            sectors = max(int(2 * np.pi * radius.mean() / (4 * spacing)), 6)
            sector = ((angle / (2 * np.pi) + 0.5) * sectors).astype(int) % sectors
            parts = [radius[sector == k] for k in range(sectors)]
            if not all(len(part) for part in parts):
                return None
            inner, outer = [part.min() for part in parts], [part.max() for part in parts]
            if np.ptp(inner) > spacing or np.ptp(outer) > spacing or min(inner) < 0.6 * max(outer) or sectors < 12:   # corners, or no hole
                return None
            rings.append([*middle, min(inner) - spacing / 2, max(outer) + spacing / 2])
        rings = np.array(rings)
        return [float(x) for x in rings.mean(axis=0)] if len(rings) and np.ptp(rings, axis=0).max() < 0.5 * self._distance(phase) else None

    def width_in_lengths(self, phase):
        """The spacing of a phase, in its smoothing lengths."""
        h = self._samples[0].get("smoothing_length", np.zeros(0))
        h = h[self._samples[0]["phase"] == phase] if len(h) else h
        middle = float(np.median(h)) if len(h) else 0.0
        return self._distance(phase) / middle if middle > 0 else 1 / 1.3

    def moving_at_once(self, phases, speed):
        """The most particles of these phases that are faster than `speed` (m/s) in one of the sampled frames."""
        return max((sum(int((np.linalg.norm(s["velocity"][s["phase"] == p], axis=1) > speed).sum()) for p in phases)
                    for s in self._samples if "velocity" in s), default=0)

    def top_speed(self, phases, share=99.5):
        """A speed (m/s) that `share` per cent of the particles of these phases do not exceed, rounded up."""
        return nice_ceiling(percentile(self.speeds(phases), share))

    def bounds(self, phases):
        """[x0, x1, y0, y1, z0, z1] in metres over the sampled frames. Particles at a side of the domain end there, walls that go on beyond it in 2D two
        spacings farther; else there is room about the particles, so that a free surface or a body does not end at the edge of the picture."""
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        free = np.zeros((2, 3), dtype=bool)   # whether a lower or an upper bound has room to come
        for phase in phases:
            points = self.values("points", [phase])
            if not len(points):
                continue
            size = self.size(phase)
            least, most = points.min(axis=0) - size / 2, points.max(axis=0) + size / 2
            wall = self.phase_kinds[phase] == "wall"
            loose = np.ones((2, 3), dtype=bool)
            if self.domain is not None:
                beyond = 2 * self.spacing if wall and self.two_dimensional else 0.0   # where it stands beyond a side
                low_side, high_side = self.domain[0::2], self.domain[1::2]
                near = 0.6 * max(size, self._distance(phase))
                loose = np.array([least > low_side + near, most < high_side - near])
                least = np.where(loose[0], least, np.where(points.min(axis=0) < low_side, np.maximum(least, low_side - beyond), low_side))
                most = np.where(loose[1], most, np.where(points.max(axis=0) > high_side, np.minimum(most, high_side + beyond), high_side))
            free[0] = np.where(least < low, loose[0], free[0] & (loose[0] | (least > low)))
            free[1] = np.where(most > high, loose[1], free[1] & (loose[1] | (most < high)))
            low, high = np.minimum(low, least), np.maximum(high, most)
        if self.domain is not None and (low <= high).all():
            room = 1.5 * self.spacing + 0.015 * (high - low)[:2 if self.two_dimensional else 3].max()
            low, high = low - room * free[0], high + room * free[1]
        if not (low <= high).all():
            low, high = np.full(3, -self.spacing / 2), np.full(3, self.spacing / 2)
        if self.two_dimensional:
            low[2] = high[2] = 0.0
        return [float(bound) for pair in zip(low, high) for bound in pair]

    def wanted_window(self, whole):
        """The window that the user asked for, [x0, x1, y0, y1] in metres, None without; `whole` are the scene's bounds."""
        words = os.environ.get("BARCHAN_WINDOW")
        if not words:
            return None
        try:
            window = [float(word) for word in words.split(",")]
        except ValueError:
            window = []
        if len(window) != 4 or not np.isfinite(window).all() or window[0] >= window[1] or window[2] >= window[3]:
            raise Wrong(f"window {words}: expected X0,X1,Y0,Y1 in metres with X0 < X1 and Y0 < Y1")
        if not self.two_dimensional:
            raise Wrong(f"window {words}: {self.path} is a 3D scene; a window is a part of a 2D scene")
        if window[0] >= whole[1] or window[1] <= whole[0] or window[2] >= whole[3] or window[3] <= whole[2]:
            raise Wrong(f"window {words} shows nothing: the scene lies in x {whole[0]:.4g} to {whole[1]:.4g} m, "
                        f"y {whole[2]:.4g} to {whole[3]:.4g} m")
        return window

    def close_up(self, rows_below=9, rows_high=34, columns=96):
        """A window [x0, x1, y0, y1] on the surface of the grains, about its highest place; all of the scene without grains."""
        grains = self.phases("grains") or [k for k, kind in enumerate(self.phase_kinds) if kind == "grains"]
        everything = self.bounds(self.phases("fluid", "grains", "elastic", "rigid") or [0])
        if self.domain is not None:   # a bed on the ground has no room below it
            everything[0::2] = np.maximum(everything[0::2], self.domain[0::2]).tolist()
            everything[1::2] = np.minimum(everything[1::2], self.domain[1::2]).tolist()
        first = self._samples[0]
        bed = first["points"][np.isin(first["phase"], grains)]
        if not len(bed) or not self.two_dimensional:
            return everything[:4]
        dx = self.spacing
        middle = 0.5 * (everything[0] + everything[1])
        top = bed[:, 1].max()
        crest = bed[bed[:, 1] > top - 0.5 * dx][:, 0]
        centre = middle if np.ptp(crest) > 0.5 * (everything[1] - everything[0]) else float(np.median(crest))
        width = min(columns * dx, everything[1] - everything[0])
        x0 = min(max(centre - width / 2, everything[0]), everything[1] - width)
        here = bed[(bed[:, 0] > x0) & (bed[:, 0] < x0 + width)]
        low = max(everything[2], here[:, 1].max() - rows_below * dx - min(np.ptp(here[:, 1]), 0.1 * width))
        flying = self.values("points", grains)
        flying = flying[(flying[:, 0] > x0) & (flying[:, 0] < x0 + width)]
        high = max(low + rows_high * dx, np.percentile(flying[:, 1], 99.9) + 3 * dx)
        return [x0, x0 + width, low, min(high, low + 0.6 * width, everything[3])]
