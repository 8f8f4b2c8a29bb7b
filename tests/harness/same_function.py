"""Whether a function is the same machine code in several ELF images, with everything that it calls.

    same_function.py FUNCTION IMAGE...

Two images place the same code and constants at other addresses. So an instruction is compared without its own address, a jump within
a function by its distance from the function's start, a call by the name of what it calls, and an address of constants by the bytes
that lie there up to the next address in use. What fills the gap behind a function is not compared. Everything else must be equal,
instruction by instruction. Prints a hash for each image; the exit status is 1 if they differ.
"""

import collections
import hashlib
import re
import subprocess
import sys

from image import read_sections

CONSTANT_BYTES = 16  # compared at an address of constants


class Image:
    def __init__(self, path):
        self.bytes = open(path, "rb").read()
        self.sections = [s for s in read_sections(self.bytes) if s.flags & 2 and s.size and s.kind != 8]
        self.functions = collections.OrderedDict()
        text = subprocess.run(
            ["arm-none-eabi-objdump", "-d", "-C", "--no-show-raw-insn", path], check=True, capture_output=True, text=True
        ).stdout
        sizes = subprocess.run(["arm-none-eabi-nm", "-S", path], check=True, capture_output=True, text=True).stdout
        end = {int(a, 16) & ~1: (int(a, 16) & ~1) + int(n, 16) for a, n in re.findall(r"^(\w+) (\w+) [tT] ", sizes, re.M)}
        lines, last = None, None
        for line in text.splitlines():
            if head := re.match(r"([0-9a-f]+) <(.*)>:$", line):
                last = end.get(int(head[1], 16))
                lines = self.functions.setdefault(head[2], [])
                if lines:  # a second function of this name: of another module, and not compared
                    lines = []
            elif lines is not None and (code := re.match(r"\s+([0-9a-f]+):\s+(.*)$", line)):
                # What follows a function to the next even word is filling.
                if last is None or int(code[1], 16) < last:
                    lines.append((int(code[1], 16), code[2]))

    def at(self, address):
        """What lies at an address of the image, or None."""
        for s in self.sections:
            if s.address <= address < s.address + s.size:
                start = s.offset + address - s.address
                return self.bytes[start : start + CONSTANT_BYTES]
        return None

    def address(self, value):
        """What stands for a value that may be an address."""
        content = self.at(value) if value > 0x100 else None
        return f"constants {content.hex()}" if content else f"{value:#x}"

    def code(self, name):
        """(lines without addresses, names of what is called)."""
        lines, calls, out = self.functions[name], [], []
        high = {}  # register -> place of the movw that waits for its movt
        for address, text in lines:
            text = re.sub(r"\s*@ .*$", "", text)
            if target := re.match(r"(\S+)\s+((?:r\d+|lr), )?([0-9a-f]+) <(.*?)(\+0x([0-9a-f]+))?>$", text):
                if target[4] == name:
                    out.append(f"{target[1]} {target[2]} here+{target[6] or 0}")
                else:
                    out.append(f"{target[1]} {target[2]} {target[4]}")
                    calls.append(target[4])
                continue
            if low := re.match(r"movw\s+(\w+), #(\d+)", text):
                high[low[1]] = (len(out), int(low[2]))
            elif (top := re.match(r"movt\s+(\w+), #(\d+)", text)) and top[1] in high:
                place, value = high.pop(top[1])
                value |= int(top[2]) << 16
                out[place] = f"movw {top[1]}, low of {self.address(value)}"
                text = f"movt {top[1]}, high of {self.address(value)}"
            elif word := re.match(r"\.word\s+0x([0-9a-f]+)", text):
                text = f".word {self.address(int(word[1], 16))}"
            out.append(re.sub(r"\s+", " ", text))
        return out, calls

    def all_code(self, root):
        """The code of a function and of all that it calls, in the order of the first call."""
        out, waiting, seen = [], [root], {root}
        while waiting:
            name = waiting.pop(0)
            lines, calls = self.code(name)
            out += [f"{name}:", *lines]
            for call in calls:
                if call in self.functions and call not in seen:
                    seen.add(call)
                    waiting.append(call)
        return out


def main():
    root, paths = sys.argv[1], sys.argv[2:]
    codes = []
    for path in paths:
        image = Image(path)
        if root not in image.functions:
            sys.exit(f"error: {path}: no function {root}")
        code = image.all_code(root)
        codes.append(code)
        print(f"{hashlib.sha256(chr(10).join(code).encode()).hexdigest()[:16]}  {len(code)} lines  {path}")
    for path, code in zip(paths[1:], codes[1:]):
        if code != codes[0]:
            at = next((i for i, (a, b) in enumerate(zip(codes[0], code)) if a != b), min(len(code), len(codes[0])))
            here, there = (c[at] if at < len(c) else "nothing" for c in (codes[0], code))
            sys.exit(f"error: {path} differs in line {at}: {there!r} instead of {here!r}")


if __name__ == "__main__":
    main()
