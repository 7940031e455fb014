"""The pages of docs/how-to, and docs/faq.md, do what they say: every command, in order.

    test_how_tos.py PROGRAM SOURCE_DIR [PAGE...]
"""
import os
import sys
import tempfile
import unittest
from pathlib import Path

import page_blocks

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
PAGES = [*sorted((SOURCE / "docs/how-to").glob("*.md")), SOURCE / "docs/faq.md"]
CHOSEN = sys.argv[3:]


class HowTos(unittest.TestCase):
    def test_every_page_is_listed(self):
        index = (SOURCE / "docs/how-to/README.md").read_text()
        for page in PAGES:
            if page.name not in ("README.md", "faq.md"):
                self.assertIn(f"({page.name})", index)

    @unittest.skipIf(os.environ.get("BARCHAN_SANITIZE"), "a sanitizer takes ten times as long; other tests run such scenes under it")
    def test_every_command_does_what_its_page_says(self):
        for page in PAGES:
            if CHOSEN and page.stem not in CHOSEN:
                continue
            with self.subTest(page.stem), tempfile.TemporaryDirectory() as name:
                at = page_blocks.folder(Path(name), PROGRAM, SOURCE)
                count = page_blocks.carry_out(page, at, SOURCE)
                if page.name != "README.md":
                    self.assertGreater(count, 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
