#!/usr/bin/env python3
"""Compares the deterministic part of two results folders: visible sets, sizes and counters of every
frame of every cell, and times on modelled devices. Used to hold builds (dev, release) equal to each
other.

usage: same_answers.py FOLDER FOLDER        exit code 0 if they are the same, 1 if not
"""
import json
import pathlib
import sys


def answers(folder):
    """Frames by what a cell measures; real times, truth keys and context left out."""
    found = {}
    for file in sorted(pathlib.Path(folder, "cells").glob("*.json")):
        cell = json.loads(file.read_text())
        key = cell["key"]
        name = (
            key["chain"],
            cell["scene"],
            key["device"],
            key["scene_hash"],
            key["path_hash"],
            key["replicate"],
        )
        is_modelled = key["device"].startswith("modelled")
        times = [round["frame_ms"] for round in cell["rounds"]] if is_modelled else []
        found[name] = times, [
            (
                frame["set"],
                frame["one_sided"],
                frame["submitted_triangles"],
                frame["draws"],
                frame["pieces"],
                sorted(frame["counters"].items()),
            )
            for frame in cell["frames"]
        ]
    return found


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    first, second = (answers(folder) for folder in sys.argv[1:])
    wrong = 0
    for name in sorted(first.keys() | second.keys()):
        if first.get(name) != second.get(name):
            wrong += 1
            print("differs:", name[0], "on", name[1], "with", name[2])
    if not first:
        print("no cells in", sys.argv[1])
        wrong = 1
    print(f"{len(first)} cells compared, {wrong} differ")
    sys.exit(1 if wrong else 0)


main()
