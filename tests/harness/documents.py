"""What is committed, read as a stranger would: `documents.py paths` and `documents.py links`.

paths: no absolute path of somebody's machine, and lock files that name no registry but crates.io.
links: relative links and `code` paths of the Markdown files lead to files of the checkout.
"""

import pathlib
import re
import subprocess
import sys

# Assembled, so that this file does not find itself.
MACHINE_PATH = re.compile(r"(?<![\w.$}])/(?:" + "|".join(["work", "root", "farm", "home/[a-z]+"]) + r")/")
CRATES_IO = 'source = "registry+https://github.com/rust-lang/crates.io-index"'
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def committed():
    names = subprocess.run(["git", "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    return [pathlib.Path(n) for n in names.split("\0") if n and pathlib.Path(n).is_file()]


def lines_of(path):
    try:
        return enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
    except UnicodeDecodeError:
        return []


def paths():
    for path in committed():
        for number, line in lines_of(path):
            if path.name == "Cargo.lock":
                if line.startswith("source = ") and line != CRATES_IO:
                    yield f"{path}:{number}: {line}"
            elif MACHINE_PATH.search(line):
                yield f"{path}:{number}: {line.strip()[:120]}"


def links():
    for path in committed():
        if path.suffix != ".md":
            continue
        for number, line in lines_of(path):
            for target in LINK.findall(line):
                if "://" in target or target.startswith("mailto:"):
                    continue
                if not (path.parent / target).exists():
                    yield f"{path}:{number}: {target} is not there"


def main():
    check = {"paths": paths, "links": links}.get(sys.argv[1] if len(sys.argv) == 2 else "")
    if check is None:
        sys.exit(__doc__)
    found = list(check())
    print("\n".join(found) or "nothing found")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
