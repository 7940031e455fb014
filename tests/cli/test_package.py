#!/usr/bin/python3
"""An installed Barchan, moved, and its Debian package work without the source tree: scripts/test-package.

    test_package.py PROGRAM SOURCE_DIR
"""
import os
import subprocess
import sys
from pathlib import Path

program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
if os.environ.get("BARCHAN_SANITIZE"):
    print("not of a build with sanitizers")
    sys.exit(0)
sys.exit(subprocess.run([source / "scripts/test-package", "--build", program.parent]).returncode)
