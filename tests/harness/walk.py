"""Follows a page of `docs/` that adds something: `walk.py PAGE FOLDER`.

FOLDER gets a copy of what git knows of the checkout (and of files that are new and not ignored). Then, in the order of the
page, every block of code that names a file (```rust file=PATH) is written there and every block of changes (```diff) is
applied. Exit status 1 where a file is there already or a change does not apply.
"""

import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r"^```(?P<kind>\S+)(?: file=(?P<file>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


def copy(folder):
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], check=True, capture_output=True, text=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        source, target = pathlib.Path(name), folder / name
        if source.is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            # Unchanged files keep their time, so that a second walk builds only what differs.
            if not target.exists() or target.read_bytes() != source.read_bytes():
                target.write_bytes(source.read_bytes())


def follow(page, folder):
    steps = 0
    for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if block["file"]:
            if pathlib.Path(block["file"]).exists():
                sys.exit(f"{page}: {block['file']} is in the checkout already; the page must add something that is not")
            (folder / block["file"]).write_text(block["text"], encoding="utf-8")
        elif block["kind"] == "diff":
            done = subprocess.run(
                ["patch", "-p1", "--forward", "--fuzz=0", "--no-backup-if-mismatch", "-r", "-", "-d", str(folder)],
                input=block["text"], capture_output=True, text=True, check=False,
            )
            if done.returncode != 0:
                sys.exit(f"{page}: this change does not apply any more:\n{block['text']}{done.stdout}{done.stderr}")
        else:
            continue
        steps += 1
    if steps == 0:
        sys.exit(f"{page}: no block names a file, and none is a change")
    print(f"{steps} blocks of {page} written and applied")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    page, folder = map(pathlib.Path, sys.argv[1:])
    copy(folder)
    follow(page, folder)


main()
