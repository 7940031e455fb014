"""docs/first-hour.md does what it says: every command, in order.

    test_first_hour.py PROGRAM SOURCE_DIR

Left out are the lines that the page marks so: cloning, installing and building, which this test's machine has done.
"""
import os
import sys
import tempfile
import unittest
from pathlib import Path

import page_blocks

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()


class FirstHour(unittest.TestCase):
    @unittest.skipIf(os.environ.get("BARCHAN_SANITIZE"), "a sanitizer takes ten times as long; other tests run such scenes under it")
    def test_every_command_does_what_the_page_says(self):
        with tempfile.TemporaryDirectory() as name:
            at = page_blocks.folder(Path(name), PROGRAM, SOURCE)
            count = page_blocks.carry_out(SOURCE / "docs/first-hour.md", at, SOURCE)
            self.assertGreaterEqual(count, 12)
            for scene in ("my_dune", "my_dam", "my_ball"):
                self.assertTrue((at / "out" / scene / f"{scene}.pvd").exists(), scene)
                self.assertTrue(list((at / "out" / scene / "pictures").glob("*.png")), scene)

    def test_a_block_that_is_wrong_is_named(self):
        cases = {"```sh\nbuild/barchan plan nowhere.toml\n```\n": "status 2",
                 "```sh\necho one\n```\n\n```text\ntwo\n```\n": "this is not printed",
                 "```python\nprint(1)\n```\n": "nothing checks it"}
        for text, message in cases.items():
            with tempfile.TemporaryDirectory() as name:
                at = page_blocks.folder(Path(name), PROGRAM, SOURCE)
                page = at / "page.md"
                page.write_text(text)
                with self.assertRaisesRegex(page_blocks.Failed, message):
                    page_blocks.carry_out(page, at, at)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
