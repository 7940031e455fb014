"""Von Mises stress of bodies: the stress in one direction that distorts as much as the whole stress does (von Mises 1913).

Needs output.fields with "von_mises_stress" or "stress".
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "von_mises_stress", "stress")
array = series.need("von_mises_stress", "stress")
figure = Figure(series, series.title + ": von Mises stress")
bodies = series.phases("elastic")
if not bodies:
    raise Wrong(f"{series.path} has no elastic body, whose stress could be shown")
xx, yy, zz, xy, yz, xz = (f"stress_{k}" for k in ("XX", "YY", "ZZ", "XY", "YZ", "XZ"))
MISES = f"sqrt(0.5*(({xx}-{yy})^2+({yy}-{zz})^2+({zz}-{xx})^2)+3*({xy}^2+{yz}^2+{xz}^2))"
if array == "stress":
    s = series.values("stress", bodies)
    values = np.sqrt(0.5 * ((s[:, 0] - s[:, 1])**2 + (s[:, 1] - s[:, 2])**2 + (s[:, 2] - s[:, 0])**2) + 3 * (s[:, 3:]**2).sum(axis=1))
else:
    values = series.values(array, bodies)
unit, factor = stress_unit(values)
formula = MISES if array == "stress" else "von_mises_stress"
sources = [series.calculated(series.source(phase), "mises", f"{1 / factor!r}*{formula}") for phase in bodies]
figure.valued_bodies(bodies, "mises", values / factor, f"von Mises stress, {unit}", sources)
figure.others(bodies)
figure.finish()
