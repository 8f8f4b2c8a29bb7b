"""Bus operations of FMI-LS-BUS 1.0 for CAN, read and written independently of the program: by the tables in chapters 4.2 and 4.5.1 of the standard.

An operation is a tuple of its name and its arguments.
"""

import struct

FORMAT_ERROR, TRANSMIT, CONFIRM, ARBITRATION_LOST, BUS_ERROR, CONFIGURATION, STATUS = 0x01, 0x10, 0x20, 0x30, 0x31, 0x40, 0x41
BIT_RATE, ARBITRATION_LOST_BEHAVIOUR = 1, 4
BUFFER, DISCARD = 1, 2
ACTIVE, PASSIVE, OFF = 1, 2, 3
BIT_ERROR, PRIMARY = 1, 1

# Arguments behind op code and length. Transmit and Format Error end in a length of two bytes and so many data.
ARGUMENTS = {TRANSMIT: "<IBB", FORMAT_ERROR: "<", CONFIRM: "<I", ARBITRATION_LOST: "<I", BUS_ERROR: "<IBBB", STATUS: "<B"}
WITH_DATA = (TRANSMIT, FORMAT_ERROR)


def write(code, *arguments):
    """The bytes of an operation."""
    if code == CONFIGURATION:
        body = struct.pack("<BI" if arguments[0] == BIT_RATE else "<BB", *arguments)
    elif code in WITH_DATA:
        *arguments, data = arguments
        body = struct.pack(ARGUMENTS[code], *arguments) + struct.pack("<H", len(data)) + data
    else:
        body = struct.pack(ARGUMENTS[code], *arguments)
    return struct.pack("<II", code, 8 + len(body)) + body


def transmit(identifier, data):
    """A frame with a standard identifier."""
    return write(TRANSMIT, identifier, 0, 0, data)


def read(stream):
    """The operations in bytes, of which all must be right."""
    found = []
    while stream:
        code, length = struct.unpack_from("<II", stream)
        body, stream = stream[8:length], stream[length:]
        assert len(body) == length - 8, "the operation is cut off"
        if code == CONFIGURATION:
            arguments = struct.unpack("<BI" if body[0] == BIT_RATE else "<BB", body)
        else:
            size = struct.calcsize(ARGUMENTS[code])
            arguments = struct.unpack_from(ARGUMENTS[code], body)
            if code in WITH_DATA:
                (count,) = struct.unpack_from("<H", body, size)
                assert len(body) == size + 2 + count
                arguments += (body[size + 2 :],)
            else:
                assert len(body) == size
        found.append((code, *arguments))
    return found
