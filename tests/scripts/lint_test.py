#!/usr/bin/env python3
"""scripts/lint finds comments that open with a piece of a sentence, by their line, and leaves good ones alone."""

import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
path = pathlib.Path(sys.argv.pop(1)) / "scripts" / "lint"
loader = importlib.machinery.SourceFileLoader("lint", str(path))
lint = importlib.util.module_from_spec(importlib.util.spec_from_loader("lint", loader))
loader.exec_module(lint)

PIECES = [
    "Of each array what the part with most of it has.",
    "As the kernels add.",
    "With programs in a folder beside the scenes.",
    "If it has more.",
    "In the order of Traversal.",
    "At most `most`.",
    "From a handler of `error`.",
    "After the last mesh. Warns of what was left out.",
    "Or sizes would change.",
    "Both, for one contribution.",
]
SENTENCES = [
    "Of two settings with one key, the newer stays.",
    "As it comes from anywhere, it is checked.",
    "In float they agree.",
    "In ODPRT rays travel between slices.",
    "For each slice, the rays that wait.",
    "At the end one launch finds nothing to do.",
    "Before a launch a queue is granted its share.",
    "The sum over the neighbours of a pixel.",
    "What a queue does next.",
    "Where the first root lies.",
    "The same, but eight entries at a time: it is for after a leaf.",
    "To double it would be wrong, since the sign is lost.",
]


class Lint(unittest.TestCase):
    def test_pieces_are_found(self):
        for text in PIECES:
            self.assertIsNotNone(lint.fault_of(text), text)

    def test_sentences_are_left_alone(self):
        for text in SENTENCES:
            self.assertIsNone(lint.fault_of(text), text)

    def test_blocks_are_told_apart(self):
        text = ("// What    A thing\n//         of two lines.\n// Shape   Round.\n#include <x>\n\n"
                "int a;  // behind code\n  // One block\n  // of two lines.\n  int b;\n//\n// Another.\n")
        self.assertEqual(list(lint.blocks_of(text)),
                         [(1, "A thing of two lines."), (3, "Round."), (7, "One block of two lines."), (11, "Another.")])


if __name__ == "__main__":
    unittest.main()
