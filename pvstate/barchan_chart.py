"""Lines over axes, of what the instruments of a scene measured (profiles, wall shear, saltation)."""

import os

import numpy as np
from paraview import servermanager
from paraview.simple import (AssignViewToLayout, CreateLayout, CreateView, GetActiveView, PlotData, SetActiveView, Show,
                             XMLPolyDataReader)
from vtkmodules.util.numpy_support import vtk_to_numpy

from barchan_marks import FONT, INK

LINES = [(0.0, 0.447, 0.698), (0.835, 0.369, 0.0), (0.0, 0.620, 0.451), (0.800, 0.475, 0.655), (0.902, 0.624, 0.0)]   # Okabe & Ito 2008


class Chart:
    """One chart in a view of its own: x over y as the axes stand, one line an array."""

    def __init__(self, title, x_title, y_title):
        busy = GetActiveView() is not None
        self.view = CreateView("XYChartView")
        if busy:
            AssignViewToLayout(view=self.view, layout=CreateLayout(name="Barchan"))
        wanted = os.environ.get("BARCHAN_SIZE", "")
        if wanted:
            width, _, height = wanted.partition("x")
            self.view.ViewSize = [int(width) // 2 * 2, int(height or 0.6 * int(width)) // 2 * 2]
        self.scale = min(max(self.view.ViewSize[0] / 1600.0, 0.5), 2.5)
        view = self.view
        view.ChartTitle, view.ChartTitleFontSize = title, int(32 * self.scale)
        view.ChartTitleColor = INK
        for axis, words in (("Left", y_title), ("Bottom", x_title)):
            setattr(view, axis + "AxisTitle", words)
            setattr(view, axis + "AxisTitleFontSize", int(29 * self.scale))
            setattr(view, axis + "AxisLabelFontSize", int(27 * self.scale))
            for part in ("Title", "Label"):
                if os.path.isfile(FONT):
                    setattr(view, f"{axis}Axis{part}FontFamily", "File")
                    setattr(view, f"{axis}Axis{part}FontFile", FONT)
        view.LegendFontSize = int(27 * self.scale)
        view.LegendLocation = "TopRight"
        self._number = 0

    @staticmethod
    def read(file):
        """The line of points that an instrument wrote (.vtp)."""
        return XMLPolyDataReader(registrationName=os.path.splitext(os.path.basename(file))[0], FileName=[file])

    @staticmethod
    def values(source, name):
        """A point array of a source, of vectors the component along x; finite values."""
        source.UpdatePipeline()
        array = vtk_to_numpy(servermanager.Fetch(source).GetPointData().GetArray(name))
        array = array[:, 0] if array.ndim > 1 else array
        return array[np.isfinite(array)]

    def span(self, axis, low, high):
        """From where to where an axis ("Left" or "Bottom") goes, instead of the range of the data."""
        setattr(self.view, axis + "AxisUseCustomRange", 1)
        setattr(self.view, axis + "AxisRangeMinimum", float(low))
        setattr(self.view, axis + "AxisRangeMaximum", float(high))

    def line(self, source, x, arrays):
        """One line for each of `arrays` {name of the array: what the legend says} over the array x. Vectors have names such as velocity_mean_X, the
        places are Points_X, Points_Y, Points_Z."""
        data = PlotData(registrationName="lines", Input=source)
        shown = Show(data, self.view, "XYChartRepresentation")
        shown.AttributeType = "Point Data"
        shown.UseIndexForXAxis = 0
        shown.XArrayName = x
        shown.SeriesVisibility = [word for name in arrays for word in (name, "1")]
        labels, colours, thick = [], [], []
        for name, words in arrays.items():
            labels += [name, words]
            colours += [name, *map(str, LINES[self._number % len(LINES)])]
            thick += [name, str(max(1, round(3 * self.scale)))]
            self._number += 1
        shown.SeriesLabel, shown.SeriesColor, shown.SeriesLineThickness = labels, colours, thick
        return shown

    def finish(self):
        """Makes the chart the active view."""
        self.view.ShowLegend = 1 if self._number > 1 else 0
        SetActiveView(self.view)
        return self.view
