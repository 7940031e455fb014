"""What reads what a run writes: the package of python/barchan, as the programs of bench/ name its parts. No other file of bench/ reads frames (.vtp, .vtu), series (.pvd) and tables
(.csv) (tests/cli/test_bench_measuring.py)."""

import sys

from barchan_bench import ROOT

sys.path.insert(0, str(ROOT / "python"))
from barchan.errors import Unreadable  # noqa: E402, F401
from barchan.frame import Frame, write_particles  # noqa: E402, F401
from barchan.series import entries as series  # noqa: E402, F401
from barchan.tables import Table, table  # noqa: E402, F401
