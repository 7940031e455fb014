"""A run that is still going: its newest frame, anew whenever the run has written another one. Speed of everything that moves, as in motion.py.

ParaView asks the source in the pipeline now and then whether there is something new (a live source). Ranges and view are those of the frames that are there
when the state is loaded; load it again for new ones. To see earlier frames, load another state, and its series again with barchan_reload.py.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

NEWEST = """
import os
import xml.etree.ElementTree as tree


def newest(series):
    # The last frame that the .pvd lists: it is whole, for the run lists a frame when it is on the disk.
    try:
        return [entry.get("file") for entry in tree.parse(series).getroot().iter("DataSet")][-1]
    except (OSError, tree.ParseError, IndexError):
        return None


"""
SCRIPT = NEWEST + """
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPPolyDataReader, vtkXMLPUnstructuredGridReader, vtkXMLUnstructuredGridReader
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
name = newest({path!r})
if name:
    readers = {{".vtu": vtkXMLUnstructuredGridReader, ".pvtp": vtkXMLPPolyDataReader, ".pvtu": vtkXMLPUnstructuredGridReader}}
    reader = readers.get(os.path.splitext(name)[1], vtkXMLPolyDataReader)()
    reader.SetFileName(os.path.join({folder!r}, name))
    part = vtkGeometryFilter()
    part.SetInputConnection(reader.GetOutputPort())
    part.Update()
    self.GetPolyDataOutput().ShallowCopy(part.GetOutput())
    self.shown = name
"""
CHECK = NEWEST + """
self.SetNeedsUpdate(newest({path!r}) not in (None, getattr(self, "shown", None)))
"""

series = start(__file__)
if not series.path.endswith(".pvd"):
    raise Wrong(f"{series.path}: the state live follows a series (.pvd)")
places = {"path": series.path, "folder": os.path.dirname(series.path)}
whole = series.bounds(series.phases("fluid", "grains", "elastic", "rigid", "wall") or [0])
if series.domain is not None:   # what moves may come to all of the domain
    for side in range(6):
        whole[side] = (min if side % 2 == 0 else max)(whole[side], float(series.domain[side]))
figure = Figure(series, series.title + ": newest frame", box=whole)
Hide(FindSource("time"), figure.view)
live_frames = LiveProgrammableSource(registrationName=series.name + " live")
live_frames.OutputDataSetType = "vtkPolyData"
live_frames.Script, live_frames.ScriptCheckNeedsUpdate = SCRIPT.format(**places), CHECK.format(**places)
series.reader = live_frames   # from here on all phases are those of the newest frame
moving = series.phases("fluid", "grains", "elastic", "rigid")
shown = [figure.particles(phase, radius="whole" if series.phase_kinds[phase] == "fluid" and series.two_dimensional else None, array="velocity",
                          layer=0 if series.phase_kinds[phase] == "fluid" else 1) for phase in moving]
figure.colours(shown, "velocity", 0.0, series.top_speed(moving), series.speed_title(moving), preset="Viridis (matplotlib)")
figure.others(moving)
figure.clock(series.reader)
figure.finish()
