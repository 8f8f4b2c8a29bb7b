"""A CAN bus of 500 kbit/s with a node that is an FMU (FMI-LS-BUS) and a plant: arbitration, lengths of frames, confirmations.

Time is counted in bits of 2 us, so that it is exact. Frames take as long as on a wire, with their stuff bits (ISO 11898-1).
"""

import ls_bus

BIT_S = 2e-6
TICK = 2500
NODE, PLANT = "node", "plant"
# Among the frames that a node wants to send: what it wanted before is void.
CANCEL = None


def bits(identifier, data):
    """Length of a frame with a standard identifier, with the space behind it."""
    # Start, identifier, no remote request, standard, reserved, length, data; then the check value.
    head = f"0{identifier:011b}000{len(data):04b}" + "".join(f"{byte:08b}" for byte in data)
    check = 0
    for bit in head:
        check <<= 1
        if (check >> 15 & 1) != int(bit):
            check ^= 0x4599
        check &= 0x7FFF
    stream = head + f"{check:015b}"
    stuffed, last, run = 0, "", 0
    for bit in stream:
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            stuffed, last, run = stuffed + 1, "10"[int(bit)], 1
    # Delimiter, acknowledgement and its delimiter, end, and space between frames.
    return len(stream) + stuffed + 13


class Node:
    """The FMU in FMPy, with what it has asked the bus for."""

    MEMBERS = ("Rx_Data", "Rx_Clock", "Tx_Data", "Tx_Clock")

    def __init__(self, instance):
        self.instance, self.slave = instance, instance.slave
        self.rx_data, self.rx_clock, self.tx_data, self.tx_clock = (
            instance.fmu.reference[f"CanChannel.{member}"] for member in self.MEMBERS
        )
        self.bit_rate = self.behaviour = None
        self.statuses, self.format_errors = [], []

    def event(self, received=b""):
        """One instant of the event mode; the frames that the node wants to send. The event mode is then left."""
        sent = b""
        if self.slave.getClock([self.tx_clock])[0]:
            (sent,) = self.slave.getBinary([self.tx_data])
        if received:
            self.slave.setClock([self.rx_clock], [True])
            self.slave.setBinary([self.rx_data], [received])
        assert not any(self.slave.updateDiscreteStates()[:5])
        self.slave.enterStepMode()
        frames = []
        for code, *arguments in ls_bus.read(sent):
            if code == ls_bus.TRANSMIT:
                identifier, extended, remote, data = arguments
                assert (extended, remote) == (0, 0)
                frames.append((identifier, data))
            elif code == ls_bus.CONFIGURATION and arguments[0] == ls_bus.BIT_RATE:
                self.bit_rate = arguments[1]
            elif code == ls_bus.CONFIGURATION:
                self.behaviour = arguments[1]
            elif code == ls_bus.STATUS:
                self.statuses += arguments
                # Whatever it has on the way is gone; it sends it again when it comes back.
                frames += [CANCEL] * (arguments == [ls_bus.OFF])
            else:
                assert code == ls_bus.FORMAT_ERROR, code
                self.format_errors += arguments
        return frames

    def step(self, step_s):
        """Whether an event is needed."""
        event, end, early, _ = self.slave.doStep(self.instance.time_s, step_s)
        assert not end and not early
        self.instance.time_s += step_s
        return event


class Bus:
    """The master: it lets the node and the plant go on from event to event, and carries their frames.

    A plant has `period` (bits) and `at(now)`, which returns the frames that it sends then, and `hear(identifier, data)`. An error is injected into
    each frame for which `destroys(identifier, start)` says so.
    """

    def __init__(self, node, plant, notified, destroys=lambda identifier, start: False):
        self.node, self.plant, self.notified, self.destroys = node, plant, notified, destroys
        self.now, self.waiting, self.current, self.lost = 0, [], None, 0
        self.ends = []
        self.request(node.event(), NODE)
        self.request(plant.at(0), PLANT)
        self.arbitrate()

    def request(self, frames, sender):
        while CANCEL in frames:
            del frames[: frames.index(CANCEL) + 1]
            self.waiting = [frame for frame in self.waiting if frame[2] != sender]
        self.waiting += [(identifier, data, sender) for identifier, data in frames]

    def run(self, until):
        while self.now < until:
            step = min(self.plant.period - self.now % self.plant.period, TICK - self.now % TICK)
            if self.current:
                step = min(step, self.current[0] - self.now)
            event = self.node.step(step * BIT_S)
            self.now += step
            received = self.delivered() if self.current and self.current[0] == self.now else b""
            if event or received:
                self.tell(received)
            if self.now % self.plant.period == 0:
                self.request(self.plant.at(self.now), PLANT)
            self.arbitrate()

    def tell(self, received):
        self.node.slave.enterEventMode()
        self.request(self.node.event(received), NODE)

    def delivered(self):
        """Ends the frame on the wire; what the node is told of it."""
        _, identifier, data, sender, destroyed = self.current
        self.current = None
        own = sender == NODE
        if destroyed:
            if not own:
                self.waiting.insert(0, (identifier, data, sender))
            return ls_bus.write(ls_bus.BUS_ERROR, identifier, ls_bus.BIT_ERROR, ls_bus.PRIMARY, own)
        self.ends.append((self.now, identifier, data))
        if own:
            self.plant.hear(identifier, data)
            return ls_bus.write(ls_bus.CONFIRM, identifier) if self.notified else b""
        return ls_bus.transmit(identifier, data)

    def arbitrate(self):
        """Begins the frame with the lowest identifier; of equal ones the first."""
        if self.current or not self.waiting:
            return
        winner = min(self.waiting, key=lambda frame: frame[0])
        self.waiting.remove(winner)
        identifier, data, sender = winner
        self.current = (self.now + bits(identifier, data), *winner, self.destroys(identifier, self.now))
        if self.notified and self.node.behaviour == ls_bus.DISCARD:
            losers = [frame for frame in self.waiting if frame[2] == NODE]
            self.waiting = [frame for frame in self.waiting if frame[2] != NODE]
            self.lost += len(losers)
            if losers:
                self.tell(b"".join(ls_bus.write(ls_bus.ARBITRATION_LOST, frame[0]) for frame in losers))
