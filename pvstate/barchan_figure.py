"""The layout of a figure in a render view: title, time, camera, axes."""

import math
import os

import numpy as np
from paraview.simple import (AnnotateTimeFilter, AssignViewToLayout, CreateLayout, CreateRenderView, GetActiveView,
                             GetAnimationScene, PythonAnnotation, SetActiveView, Show, Text)

from barchan_marks import INK, Marks, set_font
from barchan_numbers import spaced_ticks

# Sizes of letters in a picture 1600 pixels wide: those of the axes are 2 mm high in a picture 80 mm wide.
HEADING, AXIS, NUMBERS = 31, 28, 27
WIDTH_OF_A_LETTER = 0.6   # of its size


def scale_of(width):
    """Of letters, lines and margins in a picture `width` pixels wide, against one of 1600."""
    return min(max(width / 1600.0, 0.35), 2.5)


class Figure(Marks):
    """One render view laid out as a figure: title and time above, the data with axes, the colour bar below or beside."""

    last = None   # the figure that was made last

    def __init__(self, series, title, window=None, walls=True, box=None):
        """`window`: [x0, x1, y0, y1] in metres of a 2D scene, if the user asks for none; `walls`: whether the view holds them; `box`: what the view
        holds, [x0, x1, y0, y1, z0, z1] in metres, instead of the particles' bounds."""
        self.series = series
        self._wanted_box = box
        self.plain = bool(os.environ.get("BARCHAN_PLAIN"))   # what stands around the data is told, not drawn (barchan_paper.py)
        self.around = {"bars": [], "arrow": None, "axes": None}
        self.view = self._empty_view()
        Figure.last = self
        self.size = self._size(window, walls)
        self.scale = scale_of(self.size[0])
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
        self.box = self._wanted_box or series.bounds(series.phases("fluid", "grains", "elastic", "rigid", *(["wall"] if walls else [])) or [0])
        window = series.wanted_window(self.box) or window
        if window is not None:
            self.box[:4] = window
        self.whole = window is None
        series.window = list(self.box)
        if series.two_dimensional:
            extent = self.box[1] - self.box[0], self.box[3] - self.box[2]
        else:
            extent = [np.ptp(self._corners() @ direction) for direction in self._directions()[:2]]
        aspect = extent[0] / max(extent[1], 1e-30)
        self.wide = aspect > (1.6 if series.two_dimensional else 2.4)
        wanted = os.environ.get("BARCHAN_SIZE", "")
        if not wanted:
            size = list(self.view.ViewSize)
        else:
            width, _, height = wanted.partition("x")
            width = int(width)
            unit = scale_of(width)
            if height:
                size = [width, int(height)]
            else:   # the height that the data fill
                left, right, bottom, top = (m * unit for m in self._margins_1600())
                size = [width, (width - left - right) / aspect + bottom + top]
                if not self.plain:
                    size[1] = min(max(size[1], 0.25 * width), width)
            size = [int(s) // 2 * 2 for s in size]   # video wants even numbers
            self.view.ViewSize = size
        return size

    def _margins_1600(self):
        """left, right, bottom, top in pixels of a picture 1600 wide."""
        if self.plain:
            return (0, 0, 0, 0)
        if not self.series.two_dimensional:
            return (205, 90, 235, 105) if self.wide else (205, 290, 130, 105)
        return (165, 50, 212, 100) if self.wide else (165, 280, 95, 100)

    def _margins(self):
        return tuple(m * self.scale for m in self._margins_1600())

    def _heading(self, title):
        width, height = self.size
        left, right, _, top = self._margins()
        if self.plain:
            self.around["title"] = title
            return
        end = abs(self.series.times[-1])
        factor, unit, digits = self._clock_words()
        time = AnnotateTimeFilter(registrationName="time", Input=self.series.reader)
        time.Scale = factor
        time.Format = "t = {time:." + str(digits) + "f} " + unit
        room = WIDTH_OF_A_LETTER * AXIS * self.scale * len(f"t = {end * factor:.{digits}f} {unit}")
        from_right = min(right, 50 * self.scale) + room
        self._words(time, width - from_right, height - 46 * self.scale, AXIS)

        text = Text(registrationName="title", Text=title)
        size = min(HEADING, (width - left - from_right) / (WIDTH_OF_A_LETTER * self.scale * max(len(title), 1)))   # one that fits
        self._words(text, left, height - 46 * self.scale, size)

    def _words(self, source, x, y, size):
        """Words whose lower left corner stands at a pixel; `size` as in a picture 1600 pixels wide."""
        shown = Show(source, self.view)
        set_font(shown, size * self.scale)
        shown.WindowLocation = "Any Location"
        shown.Position = [x / self.size[0], y / self.size[1]]
        return shown

    def _clock_words(self):
        """Factor, unit and digits of the times of the series."""
        end = abs(self.series.times[-1])
        factor, unit = (1e6, "µs") if end < 2e-3 else (1e3, "ms") if end < 10 else (1.0, "s")
        return factor, unit, min(max(2 - math.floor(math.log10(end * factor)), 0), 3) if end > 0 else 0   # three figures

    def words_at(self, time):
        """What stands around the data of a plain figure at a time (s), for barchan_paper.py."""
        factor, unit, digits = self._clock_words()
        return {**self.around, "time": f"t = {time * factor:.{digits}f} {unit}"}

    def clock(self, source):
        """The time that the data say (TimeValue), in the place of the time of the view: of a live source."""
        width, height = self.size
        left, right, _, top = self._margins()
        words = PythonAnnotation(registrationName="time of the frame", Input=source)
        words.ArrayAssociation = "Field Data"
        words.Expression = "'t = %.6g s' % TimeValue[0]"
        self._words(words, width - right - 250 * self.scale, height - 46 * self.scale, AXIS)

    # -- camera

    def _camera_2d(self):
        view, box = self.view, self.box
        width, height = self.size
        left, right, bottom, top = self._margins()
        across, up = max(width - left - right, 1), max(height - bottom - top, 1)
        self.metres = max((box[1] - box[0]) / across, (box[3] - box[2]) / up)   # a pixel
        self.pixels_per_spacing = self.series.spacing / self.metres
        self.across, self.up = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        x = 0.5 * (box[0] + box[1]) + 0.5 * (right - left) * self.metres
        y = 0.5 * (box[2] + box[3]) + 0.5 * (top - bottom) * self.metres
        self.focus = np.array([x, y, 0.0])
        view.InteractionMode = "2D"
        view.CameraParallelProjection = 1
        view.CameraFocalPoint = [x, y, 0.0]
        # Above all layers, of which arrows are the highest (some 12 spacings), whatever the size of the scene.
        view.CameraPosition = [x, y, 2 * max(box[1] - box[0], box[3] - box[2]) + 100 * self.series.spacing]
        view.CameraViewUp = [0.0, 1.0, 0.0]
        view.CameraParallelScale = 0.5 * height * self.metres
        self._axes()

    def _axes(self):
        box = self.box
        milli = max(box[1] - box[0], box[3] - box[2]) < 1.0
        unit, factor = ("mm", 1e3) if milli else ("m", 1.0)
        axes = self.view.AxesGrid
        if self.plain:
            self.around["axes"] = {"box": [float(x) for x in box[:4]], "unit": unit, "factor": factor}
            axes.Visibility = 0
            return
        axes.Visibility = 1
        axes.UseCustomBounds = 1
        axes.CustomBounds = [*box[:4], 0.0, 0.0]
        axes.FacesToRender = 4        # the plane of the scene
        axes.AxesToLabel = 3          # below and at the left
        axes.ShowGrid, axes.ShowTicks, axes.ShowEdges = 0, 1, 1
        axes.GridColor = INK
        axes.XTitle = axes.YTitle = axes.ZTitle = ""   # ParaView would set them on the labels
        axes.DataScale = [1 / factor] * 3
        for axis, low, high in (("X", box[0], box[1]), ("Y", box[2], box[3])):
            set_font(axes, NUMBERS * self.scale, axis + "Label")
            pixels = (high - low) / self.metres / (NUMBERS * self.scale)   # in sizes of a letter
            setattr(axes, axis + "AxisUseCustomLabels", 1)
            setattr(axes, axis + "AxisLabels", spaced_ticks(low * factor, high * factor, pixels, upright=axis == "Y"))
        width, height = self.size
        left, right, bottom, top = self._margins()
        x0, y1 = width / 2 + (box[0] - self.focus[0]) / self.metres, height / 2 + (box[3] - self.focus[1]) / self.metres
        x1, y0 = width / 2 + (box[1] - self.focus[0]) / self.metres, height / 2 + (box[2] - self.focus[1]) / self.metres
        words = f"x ({unit})"
        half = 0.5 * WIDTH_OF_A_LETTER * AXIS * self.scale * len(words)
        self._words(Text(registrationName="x axis", Text=words), (x0 + x1) / 2 - half, y0 - 86 * self.scale, AXIS)
        self._words(Text(registrationName="y axis", Text=f"y ({unit})"), x0 - 22 * self.scale - 2 * half, y1 + 15 * self.scale, AXIS)

    def _directions(self):
        """Of a 3D picture: to the right, upwards, to the eye. Gravity points downwards; a strip along x is seen from its side."""
        up = 2 if self.series.up == "z" else 1
        deep = 1 if up == 2 else 2
        share = min(1.0, 3 * (self.box[2 * deep + 1] - self.box[2 * deep]) / max(self.box[1] - self.box[0], 1e-30))
        towards = np.zeros(3)
        towards[0], towards[up], towards[deep] = 0.35 * share, 0.16 + 0.26 * share, 0.84 if up == 1 else -0.84
        towards /= np.linalg.norm(towards)
        across = np.cross(np.eye(3)[up], towards)
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
        self.metres, self.across, self.up = metres, across, up
        self.pixels_per_spacing = self.series.spacing / metres
        focus = centre + across * 0.5 * (right - left) * metres + up * 0.5 * (top - bottom) * metres
        self.focus = focus
        size = np.linalg.norm([box[1] - box[0], box[3] - box[2], box[5] - box[4]])
        view.InteractionMode = "3D"
        view.CameraParallelProjection = 1
        view.CameraFocalPoint = focus
        view.CameraPosition = focus + towards * 3 * size
        view.CameraViewUp = list(up)
        view.CameraParallelScale = 0.5 * height * metres
        view.CenterOfRotation = centre
        view.AxesGrid.Visibility = 0

    def _axes_3d(self):
        """The edges of the domain, or of the part of it that the view holds, its floor, and an axis with numbers along three edges that nothing covers."""
        box = np.array(self.box, dtype=float).reshape(3, 2)
        if self.series.domain is not None:
            domain = np.array(self.series.domain, dtype=float).reshape(3, 2)
            box = np.stack([np.maximum(box[:, 0], domain[:, 0]), np.minimum(box[:, 1], domain[:, 1])], axis=1)
        up = 2 if self.series.up == "z" else 1
        unit, factor = ("mm", 1e3) if np.ptp(box, axis=1).max() < 1.0 else ("m", 1.0)
        letter = NUMBERS * self.scale
        screen = np.array([self.across, self.up])   # of a point: pixels to the right and upwards
        middle = screen @ box.mean(axis=1) / self.metres
        lines, taken = [], []   # taken: places of the numbers of other axes, in pixels
        for axis in sorted(range(3), key=lambda axis: axis != up):
            low, high = np.zeros((2, 3))
            edges = []
            for corner in range(4):
                others = [other for other in range(3) if other != axis]
                low, high = box[:, 0].copy(), box[:, 1].copy()
                for number, other in enumerate(others):
                    low[other] = high[other] = box[other, corner >> number & 1]
                edges.append((low, high))
                lines.append([low, high])
            if self.plain:
                continue
            # Upwards the edge at the left; else the lowest one.
            low, high = min(edges, key=lambda edge: (screen @ (edge[0] + edge[1]))[0 if axis == up else 1])
            begin, end = screen @ low / self.metres, screen @ high / self.metres
            length = float(np.linalg.norm(end - begin))
            if length < 2 * letter:
                continue
            away = np.array([-(end - begin)[1], (end - begin)[0]]) / length
            away *= np.sign(away @ ((begin + end) / 2 - middle)) or 1.0
            deepest, own = 0.0, []

            def set_text(words, at, size):
                """Beside a place of the edge; returns how far it reaches from the edge, in pixels."""
                half = 0.5 * np.array([WIDTH_OF_A_LETTER * size * len(words), size])
                reach = float(np.abs(away) @ half)
                self._words_in_space(words, at + (self.across * away[0] + self.up * away[1]) * (set_text.from_edge + reach) * self.metres, size)
                return set_text.from_edge + 2 * reach
            set_text.from_edge = 0.55 * letter
            upright = abs(away[0]) > abs(away[1])
            for place in spaced_ticks(low[axis] * factor, high[axis] * factor, length / letter, upright=upright):
                at = low.copy()
                at[axis] = place / factor
                point = screen @ at / self.metres + away * letter
                if any(np.linalg.norm(point - other) < 1.5 * letter for other in taken):   # where two axes meet
                    continue
                own.append(point)
                lines.append([at, at + (self.across * away[0] + self.up * away[1]) * 0.3 * letter * self.metres])
                deepest = max(deepest, set_text(f"{place:g}", at, letter))
            taken += own
            set_text.from_edge = deepest + 0.2 * letter
            set_text(f"{'xyz'[axis]} ({unit})", (low + high) / 2, AXIS * self.scale)
        self.floor(box - 2 * self.metres * (np.arange(3) == up)[:, None], up)   # below the edges
        self.lines(lines)

    def _words_in_space(self, words, place, size):
        """Words whose middle is at a place (m) of a 3D scene."""
        place = place - (self.across * 0.5 * WIDTH_OF_A_LETTER * size * len(words) + self.up * 0.4 * size) * self.metres
        text = Text(registrationName="axis: " + words, Text=words)
        shown = Show(text, self.view)
        set_font(shown, size)
        shown.TextPropMode = "Billboard 3D Text"
        shown.BillboardPosition = [float(x) for x in place]

    def place_of_pixel(self, x, y):
        """The point (m) of the picture's plane at x pixels from the left and y from below."""
        return (self.focus + self.across * (x - 0.5 * self.size[0]) * self.metres
                + self.up * (y - 0.5 * self.size[1]) * self.metres)

    # -- end

    def finish(self):
        """Draws the axes of a 3D scene and shows the last frame: a film begins where it likes, a first look should see something."""
        if not self.series.two_dimensional:
            self._axes_3d()   # now: ParaView puts names of its own, max among them, into the state that has a programmed source
        self.view.ViewTime = self.series.times[-1]
        scene = GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        scene.AnimationTime = self.series.times[-1]
        self.view.SuppressRendering = 0
        SetActiveView(self.view)
        return self.view
