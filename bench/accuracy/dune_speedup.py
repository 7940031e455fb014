#!/usr/bin/python3
"""Speed of the air within three spacings over the ground, upstream, at the crest and in the lee of scenes/paper/dune.toml.

    /usr/bin/python3 bench/accuracy/dune_speedup.py out/dune/dune.pvd [TIME]

Ground is the top of the sand, by columns of one spacing, of the grains too slow to rise by their own diameter. Prints the means over the frames of the
last fifth of the series (or of the frame nearest TIME), and exits with 1 when the crest is not above, or the lee not below,
the upstream value.
"""

import pathlib
import sys
import tomllib

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, frame  # noqa: E402


def main():
    series = pathlib.Path(sys.argv[1])
    scene = tomllib.loads((ROOT / "scenes/paper/dune.toml").read_text())
    dx, length = scene["spacing"], scene["domain"]["size"][0]
    dune = next(f for f in scene["fill"] if f["phase"] == "sand")["shape"]["dune"]
    entries = frame.series(series)
    if len(sys.argv) > 2:
        entries = [min(entries, key=lambda e: abs(e[0] - float(sys.argv[2])))]
    else:
        entries = [e for e in entries if e[0] >= 0.8 * entries[-1][0]]
    slow = (2 * 9.81 * dx) ** 0.5
    half = 0.5 * dune["length"]
    windows = {"upstream": (dune["at"] - 2.0 * half, dune["at"] - 1.2 * half), "crest": (dune["at"] - 5 * dx, dune["at"] + 5 * dx),
               "lee": (dune["at"] + 0.5 * half, dune["at"] + 1.1 * half)}
    means = {name: [] for name in windows}
    error = 0.0
    for _, path in entries:
        a = frame.Frame(path)
        x, (air, sand) = a.x, (a["phase"] == a.names.index(name) for name in ("air", "sand"))
        rest = sand & (numpy.linalg.norm(a["velocity"], axis=1) < slow)
        columns = int(round(length / dx))
        ground = numpy.zeros(columns)
        numpy.maximum.at(ground, (x[rest, 0] / dx).astype(int) % columns, x[rest, 1] + 0.5 * dx)
        height = x[air, 1] - ground[(x[air, 0] / dx).astype(int) % columns]
        speed = numpy.linalg.norm(a["velocity"][air], axis=1)
        error = max(error, abs(a["density"][air] / scene["phases"]["air"]["density"] - 1).max())
        for name, (low, high) in windows.items():
            s = (x[air, 0] - low) % length
            means[name].append(speed[(s < high - low) & (height < 3 * dx)].mean())
    result = {name: float(numpy.mean(values)) for name, values in means.items()}
    print(", ".join(f"{name} {value:.3f} m/s" for name, value in result.items()) +
          f"; speed-up at the crest {result['crest'] / result['upstream'] - 1:+.2f}; largest density error {100 * error:.2f} %")
    return 0 if result["crest"] > result["upstream"] > result["lee"] else 1


if __name__ == "__main__":
    sys.exit(main())
