#!/usr/bin/env python3
"""Lines of the controller that its tests do not run: `coverage.py LCOV`.

Lines of the unit tests themselves do not count. Uncovered lines are compared with tests/harness/uncovered.txt, which says of
each why no test runs it. An uncovered line that is not in that file is an error, and so is a line in it that is covered.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = "controller/src/"
EXPLAINED = ROOT / "tests/harness/uncovered.txt"


def main():
    counts = {}
    for line in Path(sys.argv[1]).read_text().splitlines():
        if line.startswith("SF:"):
            name = line[3:].partition(f"/{SOURCES}")[2]
            name = "" if name.endswith("tests.rs") else name
        elif line.startswith("DA:") and name:
            number, count = line[3:].split(",")[:2]
            counts.setdefault(name, {})[int(number)] = int(count)
    if not counts:
        sys.exit("the report has no line of the controller")

    uncovered, lines = [], 0
    print(f"{'file':<36}{'lines':>7}{'uncovered':>11}")
    for name in sorted(counts):
        text = (ROOT / SOURCES / name).read_text().splitlines()
        end = next((n for n, line in enumerate(text, 1) if line.startswith("#[cfg(test)]")), len(text) + 1)
        mine = {number: count for number, count in counts[name].items() if number < end}
        missed = [number for number, count in mine.items() if count == 0]
        lines += len(mine)
        uncovered += [(f"{name}: {text[number - 1].strip()}", number) for number in missed]
        if missed:
            print(f"{name:<36}{len(mine):>7}{len(missed):>11}")
    print(f"{'all':<36}{lines:>7}{len(uncovered):>11}   {100 * (1 - len(uncovered) / lines):.2f} % covered")

    explained = set()
    for line in EXPLAINED.read_text().splitlines() if EXPLAINED.exists() else []:
        if line and not line.startswith("#"):
            explained.add(line.partition(" | ")[0])
    new = [(key, number) for key, number in uncovered if key not in explained]
    stale = explained - {key for key, _ in uncovered}
    for key, number in new:
        print(f"uncovered without an explanation: line {number} of {key}")
    for key in sorted(stale):
        print(f"explained, but covered (or does not exist): {key}")
    sys.exit(1 if new or stale else 0)


if __name__ == "__main__":
    main()
