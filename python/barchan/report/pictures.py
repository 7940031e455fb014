"""Pictures of a report: those of pvstate/render where they are, and otherwise the frames drawn by matplotlib, which every report can have."""

import base64
import io
import pathlib
import re
import subprocess

import numpy

from ..errors import BarchanError, OutputError, PackageMissing
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
    places = [HERE.parents[3] / "pvstate/render", HERE.parents[3] / "share/barchan/pvstate/render", HERE.parents[2].parent / "pvstate/render"]
    tool = next((place for place in places if place.is_file()), None)
    if tool is None:
        raise OutputError("--render needs pvstate/render, which is not beside this package")
    if g.series is None or not len(g.series):
        raise OutputError(f"--render: {g.folder} has no frame")
    said = g.run.get("scene", {}).get("state") or "airflow"
    states = ",".join(said) if isinstance(said, list) else said.replace(" ", "")
    last = len(g.series) - 1
    frames = [] if film else ["--frames", ",".join(str(k) for k in sorted({0, last // 2, last}))]
    ended = subprocess.run([str(tool), str(g.series.pvd), "--state", states, "--out", str(g.folder / "pictures"), *frames, *(["--film"] if film else [])],
                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if ended.returncode:
        raise OutputError(f"--render: {ended.stderr.strip()[-600:]}")
    g.pictures, g.films = sorted((g.folder / "pictures").glob("*.png")), sorted((g.folder / "pictures").glob("*.mp4"))


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
    image = Image.open(io.BytesIO(content)).convert("RGB")
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
    top = top_speed([frame for caption, frame in frames if "bad" not in caption])
    return [(caption, draw(frame, top, g)) for caption, frame in frames if len(frame)]


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
    """Diameters (m) with which particles are drawn."""
    if "radius" in frame and (frame["radius"][chosen] > 0).all():
        return 2 * frame["radius"][chosen]
    if "smoothing_length" in frame:
        h = frame["smoothing_length"][chosen]
        return 2 * h if kind == "grains" else numpy.minimum(h, spacing * 1.1) if spacing else h
    return numpy.full(int(chosen.sum()), spacing or 1e-3)


def view_of(frame):
    """(x0, x1, y0, y1) and the axis upwards: in 3D one looks along y where gravity is likely along z."""
    two = frame.domain is None or frame.domain[2, 0] == frame.domain[2, 1]
    up = 1
    finite = frame.x[numpy.isfinite(frame.x).all(axis=1)]
    box = frame.domain if frame.domain is not None else numpy.column_stack([finite.min(axis=0), finite.max(axis=0)])
    return box[0], box[up], up, two


def draw(frame, top, g):
    """A picture of one frame as a data URI (PNG): fluids and bodies coloured by speed, grains in the colour of sand, walls grey."""
    plt = pyplot()
    (x0, x1), (y0, y1), up, two = view_of(frame)
    width, height = max(x1 - x0, 1e-12), max(y1 - y0, 1e-12)
    margin = .02 * max(width, height)
    across = 10.5
    figure, axes = plt.subplots(figsize=(across, min(max(across * .86 * (height + 2 * margin) / (width + 2 * margin) + .7, 1.9), 7.5)), dpi=110)
    axes.set(xlim=(x0 - margin, x1 + margin), ylim=(y0 - margin, y1 + margin), xlabel="x (m)", ylabel=f"{'xyz'[up]} (m)")
    axes.set_aspect("equal")
    axes.grid(False)
    figure.canvas.draw()
    points = 72 * axes.get_window_extent().width / figure.dpi / (width + 2 * margin)  # of type, in a metre
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
        s = numpy.maximum(sizes(frame, kind, chosen, spacing) * points * 1.12, .35) ** 2
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
