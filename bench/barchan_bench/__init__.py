"""What every program of bench/ shares: run.py starts commands, frame.py reads what a run writes, table.py writes figures beside their bounds, store.py
keeps results. CONTRIBUTING.md shows a program that uses them."""

import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]  # the repository
