"""What a firmware image takes: flash, RAM and the deepest stack, read from its ELF file.

    image.py IMAGE --flash BYTES --ram BYTES [--root FUNCTION]... [--stack BYTES]

Flash and RAM are sums over the loaded sections. The stack is the longest way through the call graph: frame sizes from
`.stack_sizes` (rustc's -Z emit-stack-sizes), edges from the disassembly. Recursion has no depth and a call through a
register no known end: both are said, and fail. Exit status 1 where something does not
fit, or the stack is deeper than `--stack` permits.
"""

import argparse
import collections
import re
import struct
import subprocess
import sys

Section = collections.namedtuple("Section", "name kind flags address offset size")
ALLOCATED, WRITABLE, NOBITS = 2, 1, 8
EXCEPTION_FRAME_BYTES = 104  # Cortex-M4F: 8 core and 17 FPU words, and padding to 8 bytes


def read_sections(image):
    if image[:6] != b"\x7fELF\x01\x01":
        sys.exit("error: not a 32-bit little-endian ELF image")
    (table,) = struct.unpack_from("<I", image, 32)
    size, count, names_index = struct.unpack_from("<HHH", image, 46)
    raw = [struct.unpack_from("<6I", image, table + size * i) for i in range(count)]
    names = raw[names_index][4]

    def name(at):
        return image[names + at : image.index(b"\0", names + at)].decode()

    return [Section(name(r[0]), *r[1:6]) for r in raw]


def frame_sizes(image, sections):
    """{address of a function: bytes of its frame}, from (address, ULEB128) pairs."""
    sizes = {}
    for section in sections:
        if section.name != ".stack_sizes":
            continue
        at, end = section.offset, section.offset + section.size
        while at < end:
            (address,) = struct.unpack_from("<I", image, at)
            at, value, shift = at + 4, 0, 0
            while True:
                byte = image[at]
                at, value, shift = at + 1, value | (byte & 0x7F) << shift, shift + 7
                if not byte & 0x80:
                    break
            sizes[address & ~1] = value
    return sizes


def call_graph(path):
    """{function: (address, callees, calls through a register)} from the disassembly."""
    text = subprocess.run(
        ["arm-none-eabi-objdump", "-d", "-C", "--no-show-raw-insn", path], check=True, capture_output=True, text=True
    ).stdout
    graph, here = {}, None
    for line in text.splitlines():
        if head := re.match(r"([0-9a-f]+) <(.*)>:$", line):
            here = int(head[1], 16)
            graph[here] = (head[2], set(), [])
        elif call := re.match(r"\s+[0-9a-f]+:\s+(bl|b|b\.w|b\.n|blx|bx|[a-z]+\.[nw])\s+(?:r\d+, )?([0-9a-f]+) <", line):
            graph[here][1].add(int(call[2], 16))
        elif re.match(r"\s+[0-9a-f]+:\s+blx\s+r\d+", line):
            graph[here][2].append(line.strip())
    for address, (name, callees, indirect) in graph.items():
        callees.intersection_update(graph)  # jumps within the function are no calls
        callees.discard(address)
    return graph


def deepest(graph, sizes, address, path=()):
    """(bytes, functions from `address` down) of the deepest stack below and including the function."""
    name, callees, indirect = graph[address]
    if address in path:
        sys.exit(f"error: recursion through {name}: no deepest stack")
    if indirect:
        sys.exit(f"error: {name} calls through a register, its stack is unknown: {indirect[0]}")
    below = max((deepest(graph, sizes, c, (*path, address)) for c in callees), default=(0, []))
    return sizes.get(address, 0) + below[0], [(name, sizes.get(address)), *below[1]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image")
    parser.add_argument("--flash", type=int, required=True)
    parser.add_argument("--ram", type=int, required=True)
    parser.add_argument("--root", action="append", default=[])
    parser.add_argument("--stack", type=int)
    arguments = parser.parse_args()
    image = open(arguments.image, "rb").read()
    sections = read_sections(image)
    loaded = [s for s in sections if s.flags & ALLOCATED and s.size]
    flash = sum(s.size for s in loaded if s.kind != NOBITS)
    ram = sum(s.size for s in loaded if s.flags & WRITABLE)
    print(f"flash {flash} B of {arguments.flash} ({100 * flash / arguments.flash:.1f} %), static RAM {ram} B of {arguments.ram}")

    graph, sizes = call_graph(arguments.image), frame_sizes(image, sections)
    unknown = sum(1 for address in graph if address not in sizes)
    roots = {name: address for address, (name, *_) in graph.items()}
    total = 0
    for root in arguments.root:
        if root not in roots:
            sys.exit(f"error: no function {root} in the image")
        depth, path = deepest(graph, sizes, roots[root])
        total += depth
        print(f"stack below {root}: {depth} B: " + " > ".join(f"{n} ({'?' if s is None else s})" for n, s in path))
    if arguments.root:
        total += EXCEPTION_FRAME_BYTES
        print(f"deepest stack {total} B with an exception frame ({unknown} functions without a frame size counted as 0)")
    if flash > arguments.flash or ram + total > arguments.ram:
        sys.exit("error: does not fit")
    if arguments.stack is not None and total > arguments.stack:
        sys.exit(f"error: the stack may take {arguments.stack} B")


if __name__ == "__main__":
    main()
