"""Pictures of a report: those of pvstate/render where they are, and otherwise the frames drawn by matplotlib, which every report can have."""

import base64
import io
import pathlib
import re
import subprocess

import numpy

from ..errors import BarchanError, OutputError, PackageMissing
from .gather import pictures_of
from .plots import pyplot

HERE = pathlib.Path(__file__).resolve()
MOST_BYTES = 450_000          # of one picture
MOST_BYTES_OF_FILMS = 60_000_000
SOLID = {"grains": "#C9A66B", "wall": "#9A9A9A", "rigid": "#7A8CA3"}
MOST_PARTICLES = 120_000      # drawn of one frame


def data_uri(kind, content):
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def render(g, film=False):
    """Renders pictures of the run into its folder with pvstate/render (ParaView): frames over the series, of the states that the scene names. Throws OutputError."""
    tool = HERE.parents[3] / "pvstate/render"  # of the source tree; of an installation PREFIX/share/barchan/pvstate/render
    if not tool.is_file():
        raise OutputError(f"--render needs {tool}, which is not there")
    if g.series is None or not len(g.series):
        raise OutputError(f"--render: {g.folder} has no frame")
    last = len(g.series) - 1
    frames = [] if film else ["--frames", ",".join(str(k) for k in sorted({0, last // 2, last}))]
    ended = subprocess.run([str(tool), str(g.series.pvd.absolute()), *frames, *(["--film"] if film else [])], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                           text=True, errors="replace")
    if ended.returncode:
        raise OutputError(f"--render: {ended.stderr.strip()[-600:]}")
    g.pictures, g.films = pictures_of(g)


def rendered(g):
    """(caption, data URI) of the first, a middle and the last picture of each state."""
    by_state = {}
    for file in g.pictures:
        found = re.fullmatch(r"(\w+?)_(\d{6})", file.stem)
        if found:
            by_state.setdefault(found[1], []).append((int(found[2]), file))
    shown = []
    for state, files in sorted(by_state.items()):
        for k in sorted({0, len(files) // 2, len(files) - 1}):
            number, file = files[k]
            time = f", {g.series.times[number]:.4g} s" if g.series and number < len(g.series) else ""
            shown.append((f"{state}: frame {number}{time}", data_uri(*smaller(file))))
    return shown


def smaller(file):
    """(type, bytes) of a picture: as it is, or as JPEG of at most 1400 pixels across when it is large."""
    content = file.read_bytes()
    if len(content) <= MOST_BYTES:
        return "image/png", content
    from PIL import Image  # comes with matplotlib
    image = Image.open(io.BytesIO(content), formats=["PNG"]).convert("RGB")
    image.thumbnail((1400, 1400))
    out = io.BytesIO()
    image.save(out, "JPEG", quality=88)
    return "image/jpeg", out.getvalue()


def films(g):
    """(caption, data URI) of the films, as far as they fit into a page."""
    shown, total = [], 0
    for file in g.films:
        total += file.stat().st_size
        if total > MOST_BYTES_OF_FILMS:
            g.remarks.append(f"{file.name} is not embedded: all films together are larger than {MOST_BYTES_OF_FILMS // 1_000_000} MB")
            break
        shown.append((file.stem, data_uri("video/mp4", file.read_bytes())))
    return shown


def drawn(g):
    """(caption, data URI) of frames drawn here: the first, the middle and the last of the series, and the first bad state."""
    if g.series is None:
        return []
    numbers = sorted({0, len(g.series) // 2, len(g.series) - 1}) if len(g.series) else []
    frames = []
    try:
        for k in numbers:
            try:
                frames.append((f"frame {k}, {g.series.times[k]:.4g} s", g.series[k]))
            except PackageMissing:
                raise
            except BarchanError as error:
                g.remarks.append(str(error))
        if g.state == "broken" and (bad := g.series.bad) is not None:
            frames.append((f"the first bad state, {bad.time:.6g} s" if bad.time is not None else "the first bad state", bad))
    except BarchanError as error:
        g.remarks.append(str(error))
    frames = [(caption, frame) for caption, frame in frames if len(frame)]
    good = [frame for caption, frame in frames if "bad" not in caption] or [frame for _, frame in frames]
    if not good:
        return []
    top, view = top_speed(good), view_of(good, g.said("domain", "gravity"))
    return [(caption, draw(frame, view, top, g)) for caption, frame in frames]


def top_speed(frames):
    """The end of the scale of colours, m/s: the speed that 99.5 % of what moves does not exceed, the largest of the frames."""
    tops = [0.]
    for frame in frames:
        moving = ~numpy.isin(frame["phase"], [k for k, kind in enumerate(frame.kinds) if kind == "wall"])
        speed = numpy.sqrt((frame["velocity"][moving] ** 2).sum(axis=1))
        speed = speed[numpy.isfinite(speed)]
        if len(speed):
            tops.append(float(numpy.percentile(speed, 99.5)))
    return max(tops) or 1.


def sizes(frame, kind, chosen, spacing):
    """Diameters (m) with which particles are drawn: of grains their own, of others the spacing of their phase, or of the scene (`spacing`; None: nobody knows it)."""
    if "radius" in frame and (frame["radius"][chosen] > 0).all():
        return 2 * frame["radius"][chosen]
    if spacing and kind != "grains" or "smoothing_length" not in frame:
        return numpy.full(int(chosen.sum()), spacing or 1e-3)
    return (2 if kind == "grains" else 1) * frame["smoothing_length"][chosen]


def view_of(frames, gravity=None):
    """(x0, x1), (y0, y1), the axis upwards and whether the run is in 2D. The view is the box of what moves in all these frames, within the domain and with a margin: a tall domain of a
    column of air with grains at its bottom is shown as far as the grains go. In 3D upwards is against `gravity`, or the shorter of y and z without it; one looks along the other."""
    domain = frames[0].domain
    boxes = []
    for frame in frames:
        moving = ~numpy.isin(frame["phase"], [k for k, kind in enumerate(frame.kinds) if kind == "wall"]) & numpy.isfinite(frame.x).all(axis=1)
        chosen = moving if moving.any() else numpy.isfinite(frame.x).all(axis=1)
        if chosen.any():
            boxes.append((frame.x[chosen].min(axis=0), frame.x[chosen].max(axis=0)))
    if not boxes:
        return (0., 1.), (0., 1.), 1, True
    low, high = numpy.min([b[0] for b in boxes], axis=0), numpy.max([b[1] for b in boxes], axis=0)
    if domain is not None:
        low, high = numpy.clip(low, *domain.T), numpy.clip(high, *domain.T)
    two = domain is None and low[2] == high[2] or domain is not None and domain[2, 0] == domain[2, 1]
    size = high - low
    weighs = isinstance(gravity, list) and len(gravity) == 3 and any(gravity[1:])
    up = 1 if two else 1 + int(abs(gravity[2]) > abs(gravity[1])) if weighs else 1 + int(size[1] > size[2])
    margin = .08 * max(size[0], size[up], 1e-12)
    low, high = low - margin, high + margin
    if domain is not None:  # a small margin beyond the domain, for its walls
        edge = .02 * (domain[:, 1] - domain[:, 0]).max()
        low, high = numpy.maximum(low, domain[:, 0] - edge), numpy.minimum(high, domain[:, 1] + edge)
    return (low[0], high[0]), (low[up], high[up]), up, two


def draw(frame, view, top, g):
    """A picture of one frame as a data URI (PNG): fluids and bodies coloured by speed, grains in the colour of sand, walls grey."""
    plt = pyplot()
    (x0, x1), (y0, y1), up, two = view
    width, height = max(x1 - x0, 1e-12), max(y1 - y0, 1e-12)
    across = 10.5
    figure, axes = plt.subplots(figsize=(across, min(max(across * .86 * height / width + .7, 1.9), 7.5)), dpi=110)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), xlabel="x (m)", ylabel=f"{'xyz'[up]} (m)")
    axes.set_aspect("equal")
    axes.grid(False)
    figure.canvas.draw()
    points = 72 * axes.get_window_extent().width / figure.dpi / width  # of type, in a metre
    spacing, coloured = g.run.get("scene", {}).get("spacing"), None
    order = sorted(range(len(frame.names)), key=lambda k: ("fluid", "column", "wall", "elastic", "rigid", "grains").index(frame.kinds[k]) if k < len(frame.kinds) and frame.kinds[k] in
                   ("fluid", "column", "wall", "elastic", "rigid", "grains") else 3)
    for k in order or [0]:
        kind = frame.kinds[k] if k < len(frame.kinds) else "fluid"
        chosen = frame["phase"] == k if len(frame.names) > 1 else numpy.ones(len(frame), bool)
        chosen = chosen & numpy.isfinite(frame.x).all(axis=1)
        if chosen.sum() > MOST_PARTICLES:
            keep = numpy.flatnonzero(chosen)[::int(numpy.ceil(chosen.sum() / MOST_PARTICLES))]
            chosen = numpy.zeros(len(frame), bool)
            chosen[keep] = True
        if not chosen.any():
            continue
        x = frame.x[chosen]
        own = (g.plan or {}).get("phases", {}).get(frame.names[k] if k < len(frame.names) else "", {}).get("spacing")
        s = numpy.maximum(sizes(frame, kind, chosen, own or spacing) * points * 1.12, .35 if chosen.sum() > 300 else 4.) ** 2  # a few particles must be seen
        nearest_last = numpy.argsort(-x[:, 3 - up], kind="stable") if not two else slice(None)
        x, s = x[nearest_last], s[nearest_last] if numpy.ndim(s) else s
        speed = numpy.sqrt((frame["velocity"][chosen] ** 2).sum(axis=1))[nearest_last]
        single = kind in SOLID and not (kind in ("grains", "rigid") and not any(other in ("fluid", "elastic") for other in frame.kinds))
        if single:
            axes.scatter(x[:, 0], x[:, up], s=s, c=SOLID[kind], linewidths=0, rasterized=True)
        else:
            coloured = axes.scatter(x[:, 0], x[:, up], s=s, c=numpy.where(numpy.isfinite(speed), speed, top), cmap="viridis", vmin=0, vmax=top, linewidths=0, rasterized=True)
    if coloured is not None:
        figure.colorbar(coloured, label="speed (m/s)", shrink=.85, pad=.02, extend="max")
    out = io.BytesIO()
    figure.savefig(out, format="png", bbox_inches="tight", pad_inches=.05)
    plt.close(figure)
    return data_uri("image/png", out.getvalue())
