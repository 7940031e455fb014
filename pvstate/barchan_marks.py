"""What a figure draws into its view: discs, arrows with their scale, kernels, colours."""

import math
import os

import numpy as np
from paraview.simple import (Calculator, ColorBy, GetColorTransferFunction, GetScalarBar, Glyph, Plane, ProgrammableFilter,
                             ProgrammableSource, Show, Text)

from barchan_numbers import bar_ticks, round_floor

SAND = [0.86, 0.66, 0.34]           # ochre
WALL = [0.38, 0.38, 0.40]
GROUND = [0.55, 0.42, 0.25]         # walls of a scene with grains: of one family with the sand
BODY = [0.55, 0.57, 0.60]
FAINT_AIR = [0.80, 0.87, 0.93]
FLOOR = [0.93, 0.93, 0.92]          # of the box of a 3D scene
INK = [0.13, 0.13, 0.15]
MARK = [0.835, 0.369, 0.0]          # vermilion of Okabe & Ito, Color Universal Design (2008)
# Grains at rest have the colour of sand; the faster, the darker (luminance falls all the way).
SAND_SPEED = [0.0, *SAND, 0.35, 0.84, 0.42, 0.16, 0.7, 0.62, 0.13, 0.16, 1.0, 0.28, 0.02, 0.20]
# Zero is white; blue and red can be told apart by the colour-blind.
SIGNED = [-1.0, 0.08, 0.32, 0.62, -0.5, 0.42, 0.67, 0.85, 0.0, 0.97, 0.97, 0.97,
          0.5, 0.93, 0.52, 0.40, 1.0, 0.68, 0.07, 0.15]
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"

SMOOTH = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkClipPolyData
from vtkmodules.vtkFiltersGeometry import vtkImageDataGeometryFilter
from vtkmodules.util.numpy_support import numpy_to_vtk
x0, y0, step, columns, rows, array, low, high, z, widths = {x0!r}, {y0!r}, {step!r}, {columns}, {rows}, {array!r}, {low!r}, {high!r}, {z!r}, {widths!r}
far = {far!r}   # of the upper edges, in steps
weights, sums = np.zeros(columns * rows), np.zeros(columns * rows)
for particles, lengths in zip(inputs, widths):
    if not particles.GetNumberOfPoints():
        continue
    x = np.asarray(particles.Points)[:, :2]
    width = np.asarray(particles.PointData["smoothing_length"]) * lengths
    value = np.asarray(particles.PointData[array]) if array else np.zeros(len(x))
    value = np.linalg.norm(value, axis=1) if value.ndim > 1 else value
    sane = np.isfinite(x).all(axis=1) & np.isfinite(value) & (width > 0)
    x, width, value = x[sane], width[sane], np.clip(value[sane], low, high)   # one particle that went astray decides nothing
    place = (x - (x0, y0)) / step
    reach = np.maximum(1.5 * width / step, 1.2)   # of a particle, in steps
    for axis in (0, 1):   # what ends at an edge of the picture goes on as in a mirror
        for edge in (0.0, far[axis]):
            near = np.abs(place[:, axis] - edge) < reach
            mirrored = place[near].copy()
            mirrored[:, axis] = 2 * edge - mirrored[:, axis]
            place, reach, width, value = np.concatenate([place, mirrored]), *(np.concatenate([a, a[near]]) for a in (reach, width, value))
    share = 3 / np.pi * (width / step / reach) ** 2   # inside of a fluid the weights sum to one
    for n in np.unique(np.ceil(reach).astype(int)):
        chosen = np.ceil(reach).astype(int) == n
        p, r, s, v = place[chosen], reach[chosen], share[chosen], value[chosen]
        near = np.round(p).astype(int)
        for dx in range(-n, n + 1):
            for dy in range(-n, n + 1):
                column, row = near[:, 0] + dx, near[:, 1] + dy
                w = s * np.clip(1 - ((column - p[:, 0]) ** 2 + (row - p[:, 1]) ** 2) / r ** 2, 0, None) ** 2
                w[(column < 0) | (column >= columns) | (row < 0) | (row >= rows)] = 0.0
                cell = np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)
                weights += np.bincount(cell, w, columns * rows)
                sums += np.bincount(cell, w * v, columns * rows)
if {filled}:   # empty space that walls and the lower edge of the picture enclose is ground, where no other particle is
    def spread(seed, empty):
        # All of `empty` that is joined to `seed`, by rows and columns in turn.
        before = -1
        while seed.sum() != before:
            before = seed.sum()
            for _ in range(2):
                seed, empty = seed.T, np.ascontiguousarray(empty.T)
                row = np.pad(empty, ((0, 0), (0, 1))).ravel()
                run = np.cumsum(~row)
                hit = np.bincount(run, np.pad(seed & empty, ((0, 0), (0, 1))).ravel()) > 0
                seed = (hit[run] & row).reshape(len(empty), -1)[:, :-1]
        return seed
    weights = weights.reshape(rows, columns)
    empty, air, ground = weights < {outline}, np.zeros((rows, columns), bool), np.zeros((rows, columns), bool)
    for side in (0, -1):   # a gap of two spacings below a wall that leaves the picture is none
        lowest = np.flatnonzero(~empty[:, side]).min(initial=rows)
        air[0 if lowest > 8 else lowest:, side] = True
    air[-1] = ground[0] = True
    for particles in inputs[len(widths):]:
        if particles.GetNumberOfPoints():
            x = np.round((np.asarray(particles.Points)[:, :2] - (x0, y0)) / step)
            column, row = x[np.isfinite(x).all(axis=1)].T.astype(int)
            there = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
            air[row[there], column[there]] = True
    weights[spread(ground, empty & ~spread(air & empty, empty))] = 1.0
    weights = weights.ravel()
image = vtkImageData()
image.SetDimensions(columns, rows, 1)
image.SetOrigin(x0, y0, z)
image.SetSpacing(step, step, step)
for name, numbers in (("weight", weights), ("smooth", sums / np.maximum(weights, 1e-9))):
    made = numpy_to_vtk(numbers, deep=True)
    made.SetName(name)
    image.GetPointData().AddArray(made)
image.GetPointData().SetActiveScalars("weight")
surface = vtkImageDataGeometryFilter()
surface.SetInputData(image)
clip = vtkClipPolyData()
clip.SetInputConnection(surface.GetOutputPort())
clip.SetValue({outline})
clip.Update()
output.ShallowCopy(clip.GetOutput())
if output.GetNumberOfPoints():   # the last row may lie beyond the upper edge
    places = np.array(output.Points)
    places[:, 1] = np.minimum(places[:, 1], y0 + far[1] * step)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(places, deep=True))
    output.SetPoints(points)
"""

MEAN_VELOCITY = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.util.numpy_support import numpy_to_vtk
x0, y0, sides, columns, rows, fastest, widths = {x0!r}, {y0!r}, {sides!r}, {columns}, {rows}, {fastest!r}, {widths!r}
areas, sums, places = np.zeros(columns * rows), np.zeros((columns * rows, 3)), np.zeros((columns * rows, 2))
for particles, lengths in zip(inputs, widths):
    if not particles.GetNumberOfPoints():
        continue
    x = np.asarray(particles.Points)
    velocity = np.asarray(particles.PointData["velocity"])
    area = (np.asarray(particles.PointData["smoothing_length"]) * lengths) ** 2
    column, row = ((x[:, k] - o) / sides[k] + 1e-5 for k, o in ((0, x0), (1, y0)))   # a row of a lattice on an edge is in one cell
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    inside &= (velocity ** 2).sum(axis=1) < fastest ** 2   # not a number is not below
    velocity, area = velocity[inside], area[inside]
    cell = row[inside].astype(int) * columns + column[inside].astype(int)
    areas += np.bincount(cell, area, columns * rows)
    places += np.stack([np.bincount(cell, area * x[inside, k], columns * rows) for k in range(2)], axis=1)
    sums += np.stack([np.bincount(cell, area * velocity[:, k], columns * rows) for k in range(3)], axis=1)
full = np.flatnonzero(areas > 0.5 * sides[0] * sides[1])
if len(full):
    centre = np.stack([x0 + (full % columns + 0.5) * sides[0], y0 + (full // columns + 0.5) * sides[1], 0.0 * full], axis=1)
    part = areas[full] < 0.8 * sides[0] * sides[1]   # of a cell: there the arrow stands in the fluid's middle
    centre[part, :2] = (places[full] / areas[full, None])[part]
    points = vtkPoints()
    points.SetData(numpy_to_vtk(centre, deep=True))
    output.SetPoints(points)
    output.PointData.append(sums[full] / areas[full, None], "velocity")
"""

REACH = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray
place, box = np.array({place!r}), np.array({box!r})
points, lines, discs = vtkPoints(), vtkCellArray(), vtkCellArray()


def circle(cells, x, radius, corners):
    cells.InsertNextCell(corners)
    for angle in np.linspace(0.0, 2.0 * np.pi, corners):
        cells.InsertCellPoint(points.InsertNextPoint(x[0] + radius * np.cos(angle), x[1] + radius * np.sin(angle), x[2]))


if inputs[0].GetNumberOfPoints():
    x, h = np.asarray(inputs[0].Points), np.asarray(inputs[0].PointData["smoothing_length"])
    whole = ((x[:, :2] - 2 * h[:, None] > box[0::2]) & (x[:, :2] + 2 * h[:, None] < box[1::2])).all(axis=1)
    if whole.any():   # the kernel nearest to the place that the picture holds whole
        x, h = x[whole], h[whole]
        one = ((x[:, :2] - place) ** 2).sum(axis=1).argmin()
        circle(lines, x[one], 2 * h[one], 97)
        circle(discs, x[one], {radius!r}, 17)
output.SetPoints(points)
output.SetLines(lines)
output.SetPolys(discs)
"""

ONE_ARROW = """
from vtkmodules.vtkCommonCore import vtkPoints
import numpy as np
points = vtkPoints()
points.InsertNextPoint({place!r})
output.SetPoints(points)
output.PointData.append(np.array([{velocity!r}]), "velocity")
"""


WAYS = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray
ways, speeds = {ways!r}, {speeds!r}
points, lines = vtkPoints(), vtkCellArray()
for way in ways:
    lines.InsertNextCell(len(way))
    for place in way:
        lines.InsertCellPoint(points.InsertNextPoint(place))
output.SetPoints(points)
output.SetLines(lines)
output.PointData.append(np.concatenate([np.array(v) for v in speeds]), "speed")
"""

RIM = """//VTK::Color::Impl
float dist = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (dist > 1.0) { discard; }
if (dist > 0.74) { ambientColor *= 0.62; diffuseColor *= 0.62; }
"""

RING = """
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray
centre = {centre!r}
points, strips, corners = vtkPoints(), vtkCellArray(), 361
strips.InsertNextCell(2 * corners)
for angle in np.linspace(0.0, 2.0 * np.pi, corners):
    for radius in ({inner!r}, {outer!r}):
        strips.InsertCellPoint(points.InsertNextPoint(centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), {z!r}))
output.SetPoints(points)
output.SetStrips(strips)
"""


def set_font(owner, size, prefix="", **more):
    """Font of a text, a colour bar or an axis; the properties of ParaView differ by a prefix only."""
    if os.path.isfile(FONT):
        setattr(owner, prefix + "FontFamily", "File")
        setattr(owner, prefix + "FontFile", FONT)
    setattr(owner, prefix + "FontSize", max(6, int(round(size))))
    setattr(owner, prefix + "Color", INK)
    for key, value in more.items():
        setattr(owner, prefix + key, value)


def sampled(table, low, high, count=256):
    """Colours [r, g, b] of a colour map, evenly from low to high."""
    from vtkmodules.vtkRenderingCore import vtkColorTransferFunction
    made = vtkColorTransferFunction()
    if table.ColorSpace == "Lab":
        made.SetColorSpaceToLab()
    points = list(table.RGBPoints)
    for k in range(0, len(points), 4):
        made.AddRGBPoint(*points[k:k + 4])
    return [list(made.GetColor(low + (high - low) * (k + 0.5) / count)) for k in range(count)]


def paint(shown, colour):
    """One colour for all of a representation, without light and shade."""
    shown.ColorArrayName = ["POINTS", ""]
    shown.DiffuseColor = shown.AmbientColor = colour


class Marks:
    """The drawing half of a Figure, which has series, view, box, size, scale, metres (a pixel) and wide."""

    def particles(self, phase, radius=None, colour=None, array=None, component="Magnitude", layer=0, opacity=1.0):
        """One phase as discs (balls in 3D), grains each with its own radius where the frames have it. `radius` in spacings, of grains in their diameters
        (None: touching, or overlapping where they are a few pixels only; "whole": without gaps; "body": without gaps, and hardly beyond the body's edge);
        `colour` for all, or `array` to colour by; a higher `layer` is in front. Returns the representation."""
        size = self.series.size(phase) if self.series.phase_kinds[phase] == "grains" else None
        return self.dots(self.series.source(phase), radius, colour, array, component, layer, opacity, size)

    def dots(self, source, radius=None, colour=None, array=None, component="Magnitude", layer=0, opacity=1.0, size=None):
        """As particles(), of any source of points; `size` (m) is the diameter of grains. Grains finer than three pixels are drawn with three; of larger
        ones in 2D the rim is darker, so that each can be told from its neighbours."""
        flat = self.series.two_dimensional
        if radius == "whole":   # a fluid looks like the continuum that it stands for, and stays off the axes
            radius = 1.0 if self.pixels_per_spacing < 9 else 0.85
        if radius == "body":   # half the diagonal of a square of particles is 0.707, and packings have gaps up to that
            radius = 0.75 if flat else 0.62
        pixels = (size or self.series.spacing) / self.metres
        if radius is None:
            radius = 0.5 if pixels > (4 if size else 9) or not flat else 0.72
        shown = Show(source, self.view)
        shown.SetRepresentationType("Point Gaussian")
        shown.ShaderPreset = "Plain circle" if flat else "Sphere"
        shown.GaussianRadius = radius * self.series.spacing if size is None else max(radius * size, (1.5 if flat else 2.2) * self.metres)
        shown.ScaleByArray = 0
        if size is not None and self.series.has("radius") and pixels > 4:
            shown.ScaleByArray, shown.SetScaleArray, shown.UseScaleFunction, shown.GaussianRadius = 1, ["POINTS", "radius"], 0, 2 * radius
        if size is not None and flat and pixels > 7:
            shown.ShaderPreset = "Custom"
            shown.CustomTriangleScale = 3
            shown.CustomShader = RIM
        shown.Opacity = opacity
        if flat:
            shown.Position = [0.0, 0.0, 0.05 * layer * self.series.spacing]
        if array is None:
            paint(shown, colour)
        else:
            ColorBy(shown, ("POINTS", array, component) if component else ("POINTS", array), separate=True)
        return shown

    def field(self, phases, array=None, low=0.0, high=1.0, colour=None, layer=0, sources=None, outline=0.25, others=None):
        """Phases of a 2D scene as one smooth field, whatever their spacings: at each place the mean of the particles within 1.5 spacings, weighted by
        their distance; the outline is where about half of that neighbourhood is empty. `array` (a vector counts by its size) is drawn by colours from
        `low` to `high` under the name "smooth", else all in `colour`. `sources`: other filters of these phases. `outline`: the share of a full
        neighbourhood where the area ends; 0.5 is the outline of a body, a drop alone has 0.42. `others`: phases that are not drawn; then space is
        filled that the drawn ones and the lower edge enclose and that has none of the others. Returns the representation."""
        x0, x1, y0, y1 = self.box[:4]
        widths = [self.series.width_in_lengths(p) for p in phases]
        lengths = (self.series.values("smoothing_length", [p]) for p in phases)
        finest = min((float(np.percentile(h, 1)) * w for h, w in zip(lengths, widths) if len(h)), default=self.series.spacing)
        columns = max(int((x1 - x0) / max(finest / 3, 1.5 * self.metres)), 1) + 1
        step = (x1 - x0) / (columns - 1)
        smooth = ProgrammableFilter(registrationName=(array or "outline") + " of " + self.series.names_of(phases),
                                    Input=(sources or [self.series.source(p) for p in phases]) + [self.series.source(p) for p in others or []])
        smooth.OutputDataSetType = "vtkPolyData"
        smooth.Script = SMOOTH.format(x0=float(x0), y0=float(y0), step=float(step), columns=columns, rows=math.ceil((y1 - y0) / step) + 1, far=(columns - 1.0, float((y1 - y0) / step)),
                                      array=array or "", low=float(low), high=float(high), outline=outline, filled=others is not None, z=0.05 * layer * self.series.spacing, widths=widths)
        shown = Show(smooth, self.view)
        shown.SetRepresentationType("Surface")
        shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
        if array is None:
            paint(shown, colour)
        else:
            ColorBy(shown, ("POINTS", "smooth"), separate=True)
        return shown

    def walls(self, layer=3, drawn=()):
        """Walls, in the colour of the ground where the scene has grains; in 3D faint."""
        colour = GROUND if self.series.has_grains else WALL
        walls = [phase for phase in self.series.phases("wall") if phase not in drawn]
        for phase in [phase for phase in walls if self.whole and self.series.two_dimensional]:
            ring = self.series.ring(phase)
            if ring:
                self._ring(phase, ring, colour, layer)
                walls.remove(phase)
        if walls and self.series.two_dimensional:
            others = [phase for phase in self.series.phases("fluid", "grains", "elastic", "rigid", "wall") if phase not in walls]
            self.field(walls, colour=colour, layer=layer, outline=0.5, others=others if self.whole else None)
        elif walls:
            for phase in walls:
                self.particles(phase, radius=0.12, colour=colour, opacity=0.35)

    def _ring(self, phase, ring, colour, layer):
        """A wall that is a ring, (x, y, inner radius, outer radius) in metres."""
        *centre, inner, outer = ring
        band = ProgrammableFilter(registrationName="ring of " + self.series.phase_names[phase], Input=self.series.source(phase))
        band.OutputDataSetType = "vtkPolyData"
        band.Script = RING.format(centre=centre, inner=inner, outer=outer, z=0.05 * layer * self.series.spacing)
        shown = Show(band, self.view)
        shown.SetRepresentationType("Surface")
        shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
        paint(shown, colour)

    def lines(self, lines):
        """Straight lines in a 3D scene, each from a place to another (m)."""
        source = ProgrammableSource(registrationName="edges")
        source.OutputDataSetType = "vtkPolyData"
        source.Script = WAYS.format(ways=[[list(map(float, place)) for place in line] for line in lines], speeds=[[0.0] * len(line) for line in lines])
        shown = Show(source, self.view)
        shown.SetRepresentationType("Surface")
        shown.LineWidth = max(1.0, 2.2 * self.scale)
        shown.Ambient, shown.Diffuse = 1.0, 0.0
        paint(shown, INK)

    def floor(self, box, up):
        """The lower side of a box, [[x0, x1], [y0, y1], [z0, z1]] in metres, as a quiet plane."""
        plane = Plane(registrationName="floor")
        corner = [float(side[0]) for side in box]
        plane.Origin = corner
        for name, axis in (("Point1", 0), ("Point2", 3 - up)):
            far = list(corner)
            far[axis] = float(box[axis][1])
            setattr(plane, name, far)
        shown = Show(plane, self.view)
        shown.SetRepresentationType("Surface")
        shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
        paint(shown, FLOOR)

    def bodies(self, layer=3, drawn=()):
        """Elastic and rigid bodies without a value of their own; in 2D their outline is filled."""
        for phase in self.series.phases("elastic", "rigid"):
            if phase not in drawn and self.series.two_dimensional:
                self.field([phase], colour=BODY, layer=layer, outline=0.5)
            elif phase not in drawn:
                self.particles(phase, radius="body", colour=BODY)

    # -- arrows

    def arrows(self, source, metres_per_speed, scale_of=None, colour=None, layer=6, thickness=1.0, centred=False,
               name="arrows", longest=None):
        """Velocity vectors of a source's points: `metres_per_speed` is the length in metres of 1 m/s; an arrow starts at
        its point or has its middle there. What of an arrow leaves the box is cut off. With `scale_of`, a speed (m/s), an
        arrow of that speed (or a part of it that fits) and its value stand beside the colour bar. Points faster than
        `longest` (m/s) have arrows of that speed."""
        if scale_of:
            self._arrow_scale(scale_of, metres_per_speed, thickness, name)
        array = "velocity"
        if longest:
            source, array = Calculator(registrationName=name + " no longer", Input=source), "arrow"
            source.ResultArrayName = array
            source.Function = f"velocity*min(1, {longest!r}/(mag(velocity)+1e-30))"
        glyph = self._glyph(source, metres_per_speed, thickness, centred, name, array)
        shown = Show(self.series.cut(glyph, name + " in the window", exact=True), self.view)
        self._flat_arrow(shown, colour or INK, layer)
        return shown

    @staticmethod
    def _glyph(source, metres_per_speed, thickness, centred, name, array="velocity"):
        glyph = Glyph(registrationName=name, Input=source, GlyphType="Arrow")
        glyph.OrientationArray = ["POINTS", array]
        glyph.ScaleArray = ["POINTS", array]
        glyph.VectorScaleMode = "Scale by Magnitude"
        glyph.ScaleFactor = metres_per_speed
        glyph.GlyphMode = "All Points"
        if centred:
            glyph.GlyphTransform.Translate = [-0.5, 0.0, 0.0]
        arrow = glyph.GlyphType
        arrow.TipResolution, arrow.ShaftResolution = (8, 6)
        arrow.TipLength, arrow.TipRadius, arrow.ShaftRadius = 0.32, 0.09 * thickness, 0.022 * thickness
        return glyph

    def _flat_arrow(self, shown, colour, layer):
        shown.SetRepresentationType("Surface")
        shown.Ambient, shown.Diffuse, shown.Specular = 1.0, 0.0, 0.0
        if self.series.two_dimensional:
            shown.Position = [0.0, 0.0, 2.0 * layer * self.series.spacing]
        paint(shown, colour)

    def _arrow_scale(self, speed, metres_per_speed, thickness, name):
        """An arrow of a round speed with its value, at the right of the colour bar or below it."""
        width, height = self.size
        if self.plain:
            self.around["arrow"] = {"speed": float(speed), "metres": float(speed * metres_per_speed), "name": name}
            return
        room = 0.13 * width if self.wide else 130 * self.scale        # pixels
        pixels = speed * metres_per_speed / self.metres
        if pixels > room:
            speed = round_floor(speed * room / pixels)
            pixels = speed * metres_per_speed / self.metres
        x = 0.74 * width if self.wide else width - 215 * self.scale
        y = 26 * self.scale if self.wide else 0.1 * height
        place = self.place_of_pixel(x, y)
        velocity = [float(c) for c in speed * self.across]
        source = ProgrammableSource(registrationName="scale of the arrows")
        source.OutputDataSetType = "vtkPolyData"
        source.Script = ONE_ARROW.format(place=tuple(map(float, place)), velocity=velocity)
        shown = Show(self._glyph(source, metres_per_speed, thickness, False, "one arrow"), self.view)
        self._flat_arrow(shown, INK, 6)
        value = f"{speed:g}".replace("e-0", "e-")
        text = Text(registrationName="value of the arrow", Text=f"{name}: {value} m/s" if self.wide else f"{value} m/s")
        shown = Show(text, self.view)
        set_font(shown, 26 * self.scale)
        shown.WindowLocation = "Any Location"
        shown.Position = [x / width, (y + 18 * self.scale) / height]

    def mean_velocity(self, phases, fastest):
        """The mean velocity of fluids, whatever their spacings, in nearly square cells, 40 in the box's width if that makes them 32 pixels wide; one point in
        each cell of which they fill more than half, particles faster than `fastest` (m/s) left aside. Returns the filter and the cells' side in metres."""
        held = self.series.bounds(phases)   # not that of the walls: a row of cells that is half in a wall would have arrows here and there
        x0, x1, y0, y1 = (f(a, b) for f, a, b in zip((max, min, max, min), self.box[:4], held[:4]))
        across = max(min(40, (x1 - x0) / self.metres / 32), 4)
        side = max((x1 - x0) / round(across), 3 * self.series.spacing)
        columns, rows = max(round((x1 - x0) / side), 1), max(round((y1 - y0) / side), 1)
        mean = ProgrammableFilter(registrationName="mean velocity", Input=[self.series.source(phase) for phase in phases])
        mean.OutputDataSetType = "vtkPolyData"
        mean.Script = MEAN_VELOCITY.format(x0=x0, y0=y0, sides=((x1 - x0) / columns, (y1 - y0) / rows), columns=columns, rows=rows, fastest=float(fastest),
                                           widths=[self.series.width_in_lengths(phase) for phase in phases])
        return mean, side

    def paths(self, ways, speeds):
        """Lines through places (m), with the speeds (m/s) there as their array "speed"."""
        source = ProgrammableSource(registrationName="trajectories")
        source.OutputDataSetType = "vtkPolyData"
        source.Script = WAYS.format(ways=[[list(map(float, place)) for place in way] for way in ways],
                                    speeds=[list(map(float, fast)) for fast in speeds])
        shown = Show(source, self.view)
        shown.SetRepresentationType("Surface")
        shown.LineWidth = max(1.5, 4.0 * self.scale)
        shown.Ambient, shown.Diffuse = 1.0, 0.0
        if self.series.two_dimensional:
            shown.Position = [0.0, 0.0, 4 * self.series.spacing]
        ColorBy(shown, ("POINTS", "speed"), separate=True)
        return shown

    # -- kernels

    def reach(self, phase, place, colour=MARK, layer=6):
        """A ring of radius 2h, where the kernel ends, about the particle of a phase that is nearest to a place [x, y] in each
        frame; only of particles whose ring lies within the box."""
        ring = ProgrammableFilter(registrationName="kernel of " + self.series.phase_names[phase],
                                  Input=self.series.source(phase))
        ring.OutputDataSetType = "vtkPolyData"
        ring.Script = REACH.format(place=[float(x) for x in place], box=[float(x) for x in self.box[:4]],
                                   radius=0.18 * self.series.spacing)
        shown = Show(ring, self.view)
        paint(shown, colour)
        shown.Ambient, shown.Diffuse = 1.0, 0.0
        shown.LineWidth = max(1.0, 3.0 * self.scale)
        shown.Position = [0.0, 0.0, 0.05 * layer * self.series.spacing]
        return shown

    # -- colours

    def by_values(self, representations, array, values, title):
        """Colours by an array over the range of `values` (Series.range_of): blue and red about a white zero where it has both signs."""
        low, high, signed = self.series.range_of(values)
        if signed:
            self.colours(representations, array, low, high, title, points=SIGNED)
        else:
            self.colours(representations, array, low, high, title, preset="Viridis (matplotlib)")

    def fluids(self, phases, array, values, title, sources=None):
        """Fluids coloured by an array, by_values(): in 2D as a smooth field, in 3D as balls. `sources`: filters of these phases that have the array."""
        sources = sources or [self.series.source(phase) for phase in phases]
        if self.series.two_dimensional:
            low, high, signed = self.series.range_of(values)
            if signed:   # without a rim a fluid of a value near zero would vanish on white
                self.field(phases, colour=BODY, layer=-1, outline=0.02)
            return self.by_values([self.field(phases, array, low, high, sources=sources, outline=0.1 if signed else 0.25)], "smooth", values, title)
        shown = [self.dots(source, radius=0.5, array=array, component=None) for source in sources]
        return self.by_values(shown, array, values, title)

    def rims(self, phases):
        """A grey rim about bodies of a 2D scene."""
        for phase in phases:
            self.field([phase], colour=BODY, outline=0.3)

    def valued_bodies(self, phases, array, values, title, sources=None, layer=1):
        """Bodies coloured by an array, by_values(): in 2D each as a smooth area, in 3D as balls. `sources`: filters of these phases that have the array."""
        sources = sources or [self.series.source(phase) for phase in phases]
        if self.series.two_dimensional:
            low, high, _ = self.series.range_of(values)
            shown = [self.field([phase], array, low, high, layer=layer, sources=[source], outline=0.5) for source, phase in zip(sources, phases)]
            return self.by_values(shown, "smooth", values, title)
        return self.by_values([self.dots(source, radius="body", array=array, component=None) for source in sources], array, values, title)

    def others(self, drawn):
        """The phases that carry no colour: walls dark, bodies grey, grains in the colour of sand, fluids faint. `drawn` are left out."""
        flat = self.series.two_dimensional
        fluids = [phase for phase in self.series.phases("fluid") if phase not in drawn]
        if flat:
            self.faint(fluids)
        for phase in [] if flat else fluids:
            self.particles(phase, radius=0.12, colour=FAINT_AIR)
        for phase in self.series.phases("grains"):
            if phase not in drawn:
                self.particles(phase, colour=SAND, layer=4)
        self.bodies(drawn=drawn)
        self.walls(drawn=drawn)

    def faint(self, phases):
        """Fluids of a 2D scene as a faint area, which reaches under the grains: their surface is no edge of the fluid."""
        if phases:
            self.field(phases, colour=FAINT_AIR, outline=0.04 if self.series.has_grains else 0.25)

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
            if not bar or self.plain:
                shown.SetScalarBarVisibility(self.view, False)
                if bar:
                    self.around["bars"].append({"title": title, "low": low, "high": high, "ticks": bar_ticks(low, high), "colours": sampled(table, low, high)})
                continue
            self._bar(GetScalarBar(table, self.view), title, low, high)
            shown.SetScalarBarVisibility(self.view, True)

    def legend(self, entries):
        """Names in their colours, (name, [r, g, b]), where the colour bar would stand."""
        if self.plain:
            self.around["names"] = [list(entry) for entry in entries]
            return
        width, height = self.size
        x = 0.0
        for number, (name, colour) in enumerate(entries):
            text = Text(registrationName="name of " + name, Text="\u25cf " + name)
            shown = Show(text, self.view)
            set_font(shown, 29 * self.scale, Bold=1)
            shown.Color = colour
            shown.WindowLocation = "Any Location"
            if self.wide:
                shown.Position = [0.12 + x / width, 18 * self.scale / height]
                x += (20 * len(name) + 80) * self.scale
            else:
                shown.Position = [1 - 255 * self.scale / width, 0.6 - 48 * self.scale * number / height]

    def _bar(self, bar, title, low, high):
        width, height = self.size
        bar.Title, bar.ComponentTitle = title, ""
        bar.WindowLocation = "Any Location"
        set_font(bar, 27 * self.scale, "Title")
        set_font(bar, 26 * self.scale, "Label")
        bar.ScalarBarThickness = max(4, int(18 * self.scale))
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
            bar.Position = [1 - 215 * self.scale / width, 0.22]
