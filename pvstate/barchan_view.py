"""What the ParaView states of Barchan share: finding the series, its phases and ranges, and drawing them as a figure.

A state opens in ParaView (File > Load State) and runs in pvpython alike. It takes what it needs from the environment:

    BARCHAN_SERIES   the series, a .pvd     (else --series FILE, else the newest out/*/*.pvd near the state or the working folder)
    BARCHAN_SIZE     picture, "1600x900" or "1600x" for the height that fits the data    (ParaView's window decides otherwise)
    BARCHAN_WINDOW   part of a 2D scene to show, "x0,x1,y0,y1" in metres
    BARCHAN_HIDE     phases not to draw, "air,wall"

Of a frame it reads the point arrays phase, velocity and smoothing_length and the field data phase_names and, where there is
one, phase_kinds (fluid, grains, elastic, wall for each phase).
"""

import glob
import json
import math
import os
import sys

import numpy as np
from paraview import servermanager
from paraview.simple import *  # noqa: F403  (the states use ParaView's own names)
from vtkmodules.util.numpy_support import vtk_to_numpy

SAND = [0.86, 0.66, 0.34]           # ochre
WALL = [0.38, 0.38, 0.40]
FAINT_AIR = [0.80, 0.87, 0.93]
INK = [0.13, 0.13, 0.15]
# Grains at rest have the colour of sand; the faster, the darker (luminance falls all the way).
SAND_SPEED = [0.0, *SAND, 0.35, 0.84, 0.42, 0.16, 0.7, 0.62, 0.13, 0.16, 1.0, 0.28, 0.02, 0.20]

KIND_BY_NAME = {
    "fluid": ("air", "gas", "wind", "water", "oil", "fluid", "liquid", "lubricant", "left-gas"),
    "grains": ("sand", "grain", "dust", "snow", "gravel"),
    "wall": ("wall", "ground", "boundary", "ghost", "bottom", "floor", "plate-fixed"),
}


# ---- the series ------------------------------------------------------------------------------------------------------

def find_series(state_file):
    """The .pvd to show. Raises RuntimeError with what was tried."""
    chosen = os.environ.get("BARCHAN_SERIES")
    if not chosen and "--series" in sys.argv[:-1]:
        chosen = sys.argv[sys.argv.index("--series") + 1]
    if chosen:
        if not os.path.isfile(chosen):
            raise RuntimeError(f"there is no series '{chosen}'")
        return os.path.abspath(chosen)
    places = [os.getcwd(), os.path.dirname(os.path.dirname(os.path.abspath(state_file)))]
    found = [path for place in places for path in glob.glob(os.path.join(place, "out", "*", "*.pvd"))]
    if not found:
        raise RuntimeError("no series: set BARCHAN_SERIES to a .pvd, or run a scene first (looked for out/*/*.pvd in "
                           + " and ".join(places) + ")")
    return os.path.abspath(max(found, key=os.path.getmtime))


def kind_of(name):
    """The kind of a phase by its name, for a series that does not say it."""
    for kind, words in KIND_BY_NAME.items():
        if any(word in name.lower() for word in words):
            return kind
    return "elastic"


def nice_ceiling(value):
    """The next of 1, 1.2, 1.6, 2, 2.4, 3, 3.6, 4, 5, ... 10 times a power of ten."""
    if not (value > 0 and math.isfinite(value)):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(m * power for m in (1, 1.2, 1.6, 2, 2.4, 3, 3.6, 4, 5, 6, 7, 8, 9, 10, 12) if m * power >= value * (1 - 1e-6))


def ticks(low, high, count=6):
    """Round numbers from low to high, about `count` of them."""
    step = (high - low) / max(count, 1)
    if step <= 0:
        return [low]
    power = 10.0 ** math.floor(math.log10(step))
    step = min((m * power for m in (1, 2, 2.5, 5, 10)), key=lambda s: abs(math.log(s / step)))
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, int(math.floor(high / step + 1e-9)) + 1)]


def bar_ticks(low, high):
    """As ticks(), but with one at each end where a round step allows it."""
    for count in (5, 4, 6, 3, 7, 8):
        step = (high - low) / count
        digits = step / 10.0 ** math.floor(math.log10(step)) if step > 0 else 0
        if any(abs(digits - m) < 1e-6 for m in (1, 2, 2.5, 3, 4, 5)) and abs(low / step - round(low / step)) < 1e-6:
            return [low + k * step for k in range(count + 1)]
    return ticks(low, high, 5)


class Series:
    """A series opened in ParaView: its reader, times, phases, spacing (m) and bounds (m)."""

    def __init__(self, path):
        self.path = path
        self.name = os.path.splitext(os.path.basename(path))[0]
        self.reader = PVDReader(registrationName=self.name, FileName=path)
        self.times = list(np.atleast_1d(self.reader.TimestepValues)) or [0.0]
        self.hidden = {name.strip() for name in os.environ.get("BARCHAN_HIDE", "").split(",")} - {""}

        n = len(self.times)
        self._samples = {}
        for k in sorted({0, n // 4, n // 2, 3 * n // 4, n - 1}):
            self._samples[k] = self._fetch(self.times[k])
        first = self._samples[0]
        self.phase_names = first["phase_names"] or ["phase"]
        kinds = first["phase_kinds"]
        self.phase_kinds = kinds if len(kinds) == len(self.phase_names) else [kind_of(name) for name in self.phase_names]
        unknown = self.hidden - set(self.phase_names)
        if unknown:
            raise RuntimeError(f"no phase '{unknown.pop()}' to hide in {path}; it has " + ", ".join(self.phase_names))
        self.two_dimensional = all(np.ptp(s["points"][:, 2]) == 0 for s in self._samples.values())
        self.spacing = self._find_spacing(first)
        self._thresholds = {}
        self.window = None              # [x0, x1, y0, y1] in metres: only these particles are drawn
        self.title = self._find_title()

    def _fetch(self, time):
        self.reader.UpdatePipeline(time)
        data = servermanager.Fetch(self.reader)
        if data is None or not data.GetNumberOfPoints():
            raise RuntimeError(f"no particles in {self.path} at time {time:g} s")
        sample = {"points": vtk_to_numpy(data.GetPoints().GetData()).astype(float)}
        for name in ("id", "phase", "velocity", "smoothing_length"):
            array = data.GetPointData().GetArray(name)
            if array is not None:
                sample[name] = vtk_to_numpy(array).copy()
        for name in ("phase", "velocity"):
            if name not in sample:
                raise RuntimeError(f"{self.path} has no point array '{name}': is it a series of Barchan?")
        for name in ("phase_names", "phase_kinds"):
            strings = data.GetFieldData().GetAbstractArray(name)
            sample[name] = [strings.GetVariantValue(k).ToString() for k in range(strings.GetNumberOfValues())] if strings else []
        return sample

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

    def _find_title(self):
        return self._from_run("title") or self.name.replace("_", " ").replace("-", " ").capitalize()

    def _from_run(self, key):
        """What the run's run.json says of its scene (title, spacing), None when it does not."""
        try:
            with open(os.path.join(os.path.dirname(self.path), "run.json"), encoding="utf-8") as file:
                return json.load(file)["scene"].get(key)
        except (OSError, ValueError, LookupError, TypeError, AttributeError):
            return None

    # -- phases

    def phases(self, *kinds):
        """Numbers of the phases of these kinds that are there and not hidden."""
        return [k for k, (name, kind) in enumerate(zip(self.phase_names, self.phase_kinds))
                if kind in kinds and name not in self.hidden]

    def source(self, phase):
        """The particles of one phase, a Threshold in the pipeline."""
        if phase not in self._thresholds:
            part = Threshold(registrationName=self.phase_names[phase], Input=self.reader)
            part.Scalars = ["POINTS", "phase"]
            part.LowerThreshold, part.UpperThreshold = phase - 0.5, phase + 0.5
            if self.window is not None:   # what lies outside must not be drawn over the title and the axes
                x0, x1, y0, y1 = self.window
                box = Clip(registrationName=self.phase_names[phase] + " in the window", Input=part, ClipType="Box")
                box.ClipType.Position = [x0, y0, -self.spacing]
                box.ClipType.Length = [x1 - x0, y1 - y0, 2 * self.spacing]
                box.Invert, box.Exact = 1, 0
                part = box
            self._thresholds[phase] = part
        return self._thresholds[phase]

    # -- statistics over a few frames of the series, so that colours and camera hold still in a film

    def first(self):
        """The arrays of the first frame by name: points, id, phase, velocity, smoothing_length."""
        return self._samples[0]

    def values(self, name, phases):
        """One array of point data of these phases, of all sampled frames together."""
        parts = [s[name][np.isin(s["phase"], phases)] for s in self._samples.values() if name in s]
        return np.concatenate(parts) if parts else np.zeros(0)

    def top_speed(self, phases, share=99.8):
        """A speed (m/s) that `share` per cent of the particles of these phases do not exceed, rounded up."""
        velocity = self.values("velocity", phases)
        if not len(velocity):
            return 1.0
        speeds = np.linalg.norm(velocity, axis=1)
        speeds = speeds[np.isfinite(speeds)]
        return nice_ceiling(np.percentile(speeds, share)) if len(speeds) else 1.0

    def bounds(self, phases):
        """[x0, x1, y0, y1, z0, z1] in metres with half a spacing around, over the sampled frames."""
        points = self.values("points", phases)
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            points = np.zeros((1, 3))
        low, high = points.min(axis=0) - self.spacing / 2, points.max(axis=0) + self.spacing / 2
        if self.two_dimensional:
            low[2] = high[2] = 0.0
        return [low[0], high[0], low[1], high[1], low[2], high[2]]

    def close_up(self, rows_below=9, rows_high=34, columns=96):
        """A window [x0, x1, y0, y1] on the surface of the grains, about its highest place; all of the scene without grains."""
        grains = self.phases("grains") or [k for k, kind in enumerate(self.phase_kinds) if kind == "grains"]
        everything = self.bounds(self.phases("fluid", "grains", "elastic") or [0])
        if "BARCHAN_WINDOW" in os.environ or not grains or not self.two_dimensional:
            return everything[:4]
        dx = self.spacing
        first = self._samples[0]
        bed = first["points"][np.isin(first["phase"], grains)]
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


# ---- the figure --------------------------------------------------------------------------------------------------------

FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"


def set_font(owner, size, prefix="", **more):
    """Font of a text, a colour bar or an axis; the properties of ParaView differ by a prefix only."""
    if os.path.isfile(FONT):
        setattr(owner, prefix + "FontFamily", "File")
        setattr(owner, prefix + "FontFile", FONT)
    setattr(owner, prefix + "FontSize", max(6, int(round(size))))
    setattr(owner, prefix + "Color", INK)
    for key, value in more.items():
        setattr(owner, prefix + key, value)


class Figure:
    """One render view laid out as a figure: title and time above, the data with axes, the colour bar below or beside."""

    def __init__(self, series, title, window=None, walls=True):
        self.series = series
        self.view = self._empty_view()
        self.size = self._size(window, walls)
        self.scale = min(max(self.size[0] / 1600.0, 0.35), 2.5)   # of letters and lines
        view = self.view
        view.SuppressRendering = 1   # until finish()
        view.UseColorPaletteForBackground = 0
        view.BackgroundColorMode = "Single Color"
        view.Background = [1.0, 1.0, 1.0]
        view.OrientationAxesVisibility = 0
        view.CenterAxesVisibility = 0
        view.UseFXAA = 1
        self._heading(title)
        if series.two_dimensional:
            self._camera_2d()
        else:
            self._camera_3d()

    # -- layout

    @staticmethod
    def _empty_view():
        """The active view, or a new one in a new tab when that already shows something."""
        view = GetActiveView()
        if view is None or not hasattr(view, "CameraParallelScale") or any(r.Visibility for r in view.Representations):
            busy = view is not None
            view = CreateRenderView()
            if busy:
                AssignViewToLayout(view=view, layout=CreateLayout(name="Barchan"))
        return view

    def _size(self, window, walls):
        series = self.series
        self.box = series.bounds(series.phases("fluid", "grains", "elastic", *(["wall"] if walls else [])) or [0])
        if os.environ.get("BARCHAN_WINDOW") and series.two_dimensional:
            window = [float(x) for x in os.environ["BARCHAN_WINDOW"].split(",")]
            if len(window) != 4 or window[0] >= window[1] or window[2] >= window[3]:
                raise RuntimeError("a window is x0,x1,y0,y1 in metres with x0 < x1 and y0 < y1")
        if window is not None:
            self.box[:4] = series.window = list(window)
        if series.two_dimensional:
            extent = self.box[1] - self.box[0], self.box[3] - self.box[2]
        else:
            extent = [np.ptp(self._corners() @ direction) for direction in self._directions()[:2]]
        aspect = extent[0] / max(extent[1], 1e-30)
        self.wide = series.two_dimensional and aspect > 1.6
        wanted = os.environ.get("BARCHAN_SIZE", "")
        if not wanted:
            size = list(self.view.ViewSize)
        else:
            width, _, height = wanted.partition("x")
            width = int(width)
            unit = width / 1600.0
            if height:
                size = [width, int(height)]
            else:   # the height that the data fill
                left, right, bottom, top = (m * unit for m in self._margins_1600())
                size = [width, (width - left - right) / aspect + bottom + top]
                size[1] = min(max(size[1], 0.25 * width), width)
            size = [int(s) // 2 * 2 for s in size]   # video wants even numbers
            self.view.ViewSize = size
        return size

    def _margins_1600(self):
        """left, right, bottom, top in pixels of a picture 1600 wide."""
        if not self.series.two_dimensional:
            return (40, 250, 40, 85)
        return (140, 40, 185, 72) if self.wide else (140, 230, 95, 72)

    def _margins(self):
        return tuple(m * self.scale for m in self._margins_1600())

    def _heading(self, title):
        width, height = self.size
        left, right, _, top = self._margins()
        text = Text(registrationName="title", Text=title)
        shown = Show(text, self.view)
        set_font(shown, 26 * self.scale, Bold=0)
        shown.WindowLocation = "Any Location"
        shown.Position = [left / width, 1 - 0.68 * top / height]

        end = abs(self.series.times[-1])
        factor, unit = (1e6, "µs") if end < 2e-3 else (1e3, "ms") if end < 10 else (1.0, "s")
        digits = min(max(2 - math.floor(math.log10(end * factor)), 0), 3) if end > 0 else 0   # three figures
        time = AnnotateTimeFilter(registrationName="time", Input=self.series.reader)
        time.Scale = factor
        time.Format = "t = {time:." + str(digits) + "f} " + unit
        longest = len(f"t = {end * factor:.{digits}f} {unit}")
        shown = Show(time, self.view)
        set_font(shown, 24 * self.scale)
        shown.WindowLocation = "Any Location"
        shown.Position = [1 - (right + 14.5 * self.scale * longest) / width, 1 - 0.68 * top / height]

    def _camera_2d(self):
        view, box = self.view, self.box
        width, height = self.size
        left, right, bottom, top = self._margins()
        across, up = max(width - left - right, 1), max(height - bottom - top, 1)
        metres = max((box[1] - box[0]) / across, (box[3] - box[2]) / up)   # a pixel
        self.pixels_per_spacing = self.series.spacing / metres
        x = 0.5 * (box[0] + box[1]) + 0.5 * (right - left) * metres
        y = 0.5 * (box[2] + box[3]) + 0.5 * (top - bottom) * metres
        view.InteractionMode = "2D"
        view.CameraParallelProjection = 1
        view.CameraFocalPoint = [x, y, 0.0]
        view.CameraPosition = [x, y, 1.0]
        view.CameraViewUp = [0.0, 1.0, 0.0]
        view.CameraParallelScale = 0.5 * height * metres
        milli = max(box[1] - box[0], box[3] - box[2]) < 1.0
        unit, factor = ("mm", 1e3) if milli else ("m", 1.0)
        axes = view.AxesGrid
        axes.Visibility = 1
        axes.UseCustomBounds = 1
        axes.CustomBounds = [*box[:4], 0.0, 0.0]
        axes.FacesToRender = 4        # the plane of the scene
        axes.AxesToLabel = 3          # below and at the left
        axes.ShowGrid, axes.ShowTicks, axes.ShowEdges = 0, 1, 1
        axes.GridColor = INK
        away = " " * max(0, round(6.5 * self.scale - 2.5))   # ParaView sets the title too near to the labels
        axes.XTitle, axes.YTitle, axes.ZTitle = f"x ({unit})", f"y ({unit})" + away, ""
        axes.DataScale = [1 / factor] * 3
        for axis, low, high, pixels in (("X", box[0], box[1], (box[1] - box[0]) / metres), ("Y", box[2], box[3], (box[3] - box[2]) / metres)):
            set_font(axes, 19 * self.scale, axis + "Label")
            set_font(axes, 20 * self.scale, axis + "Title")
            places = ticks(low * factor, high * factor, min(8, max(2, pixels / (95 * self.scale))))
            setattr(axes, axis + "AxisUseCustomLabels", 1)
            setattr(axes, axis + "AxisLabels", places)

    @staticmethod
    def _directions():
        """Of a 3D picture: to the right, upwards, to the eye."""
        towards = np.array([0.35, 0.42, 0.84]) / np.linalg.norm([0.35, 0.42, 0.84])
        across = np.cross([0.0, 1.0, 0.0], towards)
        across /= np.linalg.norm(across)
        return across, np.cross(towards, across), towards

    def _corners(self):
        return np.array([[x, y, z] for x in self.box[0:2] for y in self.box[2:4] for z in self.box[4:6]])

    def _camera_3d(self):
        view, box = self.view, self.box
        width, height = self.size
        left, right, bottom, top = self._margins()
        across, up, towards = self._directions()
        corners = self._corners()
        centre = corners.mean(axis=0)
        metres = max(np.ptp(corners @ across) / max(width - left - right, 1), np.ptp(corners @ up) / max(height - bottom - top, 1))
        self.pixels_per_spacing = self.series.spacing / metres
        focus = centre + across * 0.5 * (right - left) * metres + up * 0.5 * (top - bottom) * metres
        size = np.linalg.norm([box[1] - box[0], box[3] - box[2], box[5] - box[4]])
        view.InteractionMode = "3D"
        view.CameraParallelProjection = 1
        view.CameraFocalPoint = focus
        view.CameraPosition = focus + towards * 3 * size
        view.CameraViewUp = [0.0, 1.0, 0.0]
        view.CameraParallelScale = 0.5 * height * metres
        view.CenterOfRotation = centre
        view.AxesGrid.Visibility = 0

    # -- what is drawn

    def particles(self, phase, radius=None, colour=None, array=None, component="Magnitude", layer=0, opacity=1.0):
        """One phase as discs (balls in 3D). `radius` in spacings (None: touching, or overlapping where they are a
        few pixels only); `colour` for all, or `array` to colour by; a higher `layer` is in front. Returns the representation."""
        return self.dots(self.series.source(phase), radius, colour, array, component, layer, opacity)

    def dots(self, source, radius=None, colour=None, array=None, component="Magnitude", layer=0, opacity=1.0):
        flat = self.series.two_dimensional
        if radius is None:
            radius = 0.5 if self.pixels_per_spacing > 9 or not flat else 0.72
        shown = Show(source, self.view)
        shown.SetRepresentationType("Point Gaussian")
        shown.ShaderPreset = "Plain circle" if flat else "Sphere"
        shown.GaussianRadius = radius * self.series.spacing
        shown.ScaleByArray = 0
        shown.Opacity = opacity
        if flat:
            shown.Position = [0.0, 0.0, 0.05 * layer * self.series.spacing]
        if array is None:
            shown.ColorArrayName = ["POINTS", ""]
            shown.DiffuseColor = shown.AmbientColor = colour
        else:
            ColorBy(shown, ("POINTS", array, component) if component else ("POINTS", array), separate=True)
        return shown

    def arrows(self, source, metres_per_speed, colour=None, array="velocity", component="Magnitude", layer=6,
               thickness=1.0, centred=False, name="arrows"):
        """Velocity vectors of a source's points: `metres_per_speed` is the length in metres of 1 m/s;
        an arrow starts at its point or has its middle there."""
        glyph = Glyph(registrationName=name, Input=source, GlyphType="Arrow")
        glyph.OrientationArray = ["POINTS", "velocity"]
        glyph.ScaleArray = ["POINTS", "velocity"]
        glyph.VectorScaleMode = "Scale by Magnitude"
        glyph.ScaleFactor = metres_per_speed
        glyph.GlyphMode = "All Points"
        if centred:
            glyph.GlyphTransform.Translate = [-0.5, 0.0, 0.0]
        arrow = glyph.GlyphType
        arrow.TipResolution, arrow.ShaftResolution = (8, 6)
        arrow.TipLength, arrow.TipRadius, arrow.ShaftRadius = 0.32, 0.09 * thickness, 0.022 * thickness
        shown = Show(glyph, self.view)
        shown.SetRepresentationType("Surface")
        shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
        if self.series.two_dimensional:
            shown.Position = [0.0, 0.0, 2.0 * layer * self.series.spacing]
        if colour is not None:
            shown.ColorArrayName = ["POINTS", ""]
            shown.DiffuseColor = shown.AmbientColor = colour
        else:
            ColorBy(shown, ("POINTS", array, component), separate=True)
        return shown

    def mean_velocity(self, phase, across=40):
        """The mean velocity of one phase in square cells, `across` of them in the box's width; one point in each cell that
        holds particles. Returns the filter and the cells' side in metres."""
        x0, x1, y0, y1 = self.box[:4]
        side = max((x1 - x0) / across, 3 * self.series.spacing)
        columns, rows = max(round((x1 - x0) / side), 1), max(round((y1 - y0) / side), 1)
        mean = ProgrammableFilter(registrationName="mean velocity", Input=self.series.source(phase))
        mean.OutputDataSetType = "vtkPolyData"
        mean.Script = f"""
import numpy as np
from vtkmodules.numpy_interface import dataset_adapter as adapter
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.util.numpy_support import numpy_to_vtk
x0, y0, side, columns, rows = {x0!r}, {y0!r}, {side!r}, {columns}, {rows}
particles = inputs[0]
if particles.GetNumberOfPoints():
    x = np.asarray(particles.Points)
    velocity = np.asarray(particles.PointData["velocity"])
    column, row = ((x[:, k] - o) / side for k, o in ((0, x0), (1, y0)))
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    cell = row[inside].astype(int) * columns + column[inside].astype(int)
    count = np.bincount(cell, minlength=columns * rows)
    mean = np.stack([np.bincount(cell, velocity[inside, k], columns * rows) for k in range(3)], axis=1)
    full = np.flatnonzero(count > {0.5 * (side / self.series.spacing) ** 2})   # half a cell of them; a stray is no wind
    centre = np.stack([x0 + (full % columns + 0.5) * side, y0 + (full // columns + 0.5) * side, 0.0 * full], axis=1)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(centre, deep=True))
    output.SetPoints(points)
    output.PointData.append(mean[full] / count[full, None], "velocity")
"""
        return mean, side

    def reach(self, source, colour, layer=6):
        """A ring of radius 2h about each point of a source (a few at most), where its kernel ends."""
        rings = ProgrammableFilter(registrationName="kernel", Input=source)
        rings.OutputDataSetType = "vtkPolyData"
        rings.Script = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray
points, lines = vtkPoints(), vtkCellArray()
if inputs[0].GetNumberOfPoints():
    for x, h in zip(np.asarray(inputs[0].Points), np.asarray(inputs[0].PointData["smoothing_length"])):
        lines.InsertNextCell(97)
        for angle in np.linspace(0.0, 2.0 * np.pi, 97):
            lines.InsertCellPoint(points.InsertNextPoint(x[0] + 2 * h * np.cos(angle), x[1] + 2 * h * np.sin(angle), x[2]))
output.SetPoints(points)
output.SetLines(lines)
"""
        shown = Show(rings, self.view)
        shown.ColorArrayName = ["POINTS", ""]
        shown.DiffuseColor = shown.AmbientColor = colour
        shown.Ambient, shown.Diffuse = 1.0, 0.0
        shown.LineWidth = max(1.0, 3.0 * self.scale)
        shown.Position = [0.0, 0.0, 0.05 * layer * self.series.spacing]
        return shown

    def colours(self, representations, array, low, high, title, preset=None, points=None, bar=True):
        """One colour map for these representations, and its bar."""
        for number, shown in enumerate(representations):
            table = GetColorTransferFunction(array, shown, separate=True)
            if points is not None:
                table.RGBPoints = points
                table.ColorSpace = "Lab"
            else:
                table.ApplyPreset(preset, True)
            table.RescaleTransferFunction(low, high)
            table.AutomaticRescaleRangeMode = "Never"
            if number:
                continue
            if not bar:
                shown.SetScalarBarVisibility(self.view, False)
                continue
            self._bar(GetScalarBar(table, self.view), title, low, high)
            shown.SetScalarBarVisibility(self.view, True)

    def _bar(self, bar, title, low, high):
        width, height = self.size
        bar.Title, bar.ComponentTitle = title, ""
        bar.WindowLocation = "Any Location"
        set_font(bar, 20 * self.scale, "Title")
        set_font(bar, 19 * self.scale, "Label")
        bar.ScalarBarThickness = max(4, int(16 * self.scale))
        bar.DrawTickMarks, bar.DrawTickLabels = 1, 1
        bar.AddRangeLabels = 0
        bar.UseCustomLabels = 1
        bar.CustomLabels = bar_ticks(low, high)
        largest = max(abs(low), abs(high))
        bar.LabelFormat = bar.RangeLabelFormat = "%-#.3g" if largest < 10 else "%.4g"
        if largest >= 1:
            bar.LabelFormat = "%g"
        if self.wide:
            bar.Orientation = "Horizontal"
            bar.HorizontalTitle = 1
            length = 0.36
            bar.ScalarBarLength = length
            bar.Position = [0.5 - length / 2, 16 * self.scale / height]
        else:
            bar.Orientation = "Vertical"
            bar.ScalarBarLength = 0.5
            bar.Position = [1 - 165 * self.scale / width, 0.22]

    def finish(self):
        """Shows the last frame: a film begins where it likes, a first look should see something."""
        self.view.ViewTime = self.series.times[-1]
        scene = GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        scene.AnimationTime = self.series.times[-1]
        self.view.SuppressRendering = 0
        SetActiveView(self.view)
        return self.view


def start(state_file):
    """The series that the state shows."""
    return Series(find_series(state_file))
