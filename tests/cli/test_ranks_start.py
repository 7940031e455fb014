#!/usr/bin/python3
"""Ranks that make the particles of fluids in parts, beside what every rank makes whole: the bytes of one process.

    test_ranks_start.py PROGRAM SOURCE_DIR
"""

import sys
import unittest

from test_ranks import SOURCE, Folder, has_mpi

# A disc that turns, not about the origin, and a plate that is held; both float in a fluid that is made in parts.
DISC = """
dimensions = 2
spacing = 0.04
[domain]
size = [2, 1.6]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1
viscosity = 1e-3
sound-speed = 20
[phases.disc]
kind = "rigid"
density = 2
[phases.plate]
kind = "rigid"
density = 2
[interactions]
water-water = 3.0
water-disc = 3.0
water-plate = 3.0
disc-plate = false
[[fill]]
phase = "disc"
shape = { disc = { centre = [0.6, 0.9], radius = 0.3 } }
velocity = ["0.2 - (y - 0.9)", "x - 0.6"]
[[fill]]
phase = "plate"
shape = { box = { min = [1.2, 0.4], max = [1.8, 0.56] } }
[[fill]]
phase = "water"
shape = "the-rest"
[[motion]]
phase = "plate"
about = [1.3, 0.5]
[time]
end = 0.02
largest-speed = 1
[output]
every = 0.01
history-every = 0.005
"""


@unittest.skipUnless(has_mpi(), "no MPI here")
class Start(Folder):
    def test_rigid_bodies_away_from_the_origin(self):
        self.run_on(0, DISC, "one")
        for ranks in (2, 3):
            self.run_on(ranks, DISC, f"of-{ranks}")
            self.same("one", f"of-{ranks}")

    def test_a_bed_that_settles_before_and_after_the_fluid_is_made(self):
        text = (SOURCE / "scenes/threshold.toml").read_text()
        head, *fills = text.split("[[fill]]")
        last, tail = fills[-1].split("[[forcing]]")
        sand = next(fill for fill in fills if 'phase = "sand"' in fill)
        others = [fill for fill in fills[:-1] if fill != sand]
        sets = [word for s in ("time.end=0.0001", "output.every=0.00005", "output.history-every=0.00005", "domain.size=[0.016, 0.032]")
                for word in ("--set", s)]
        for order in ([*others, sand, last], [*others, last, sand]):
            changed = head + "".join("[[fill]]" + fill for fill in order) + "[[forcing]]" + tail
            self.run_on(0, changed, "one", *sets)
            self.run_on(3, changed, "of-3", *sets)
            self.same("one", "of-3")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
