"""The wiring of a bench: what relays and generators do becomes the unit's inputs, and its outputs become contacts and
voltages. `bridge.py UNIT_PORT GENERATOR PULSES METER MODULE [SUPPLY]`: prints the port at which the tester finds the unit,
which with a supply says nothing below 70 V.

Written from protocol/WIRE.md, without this project's code. What the tester's frames say of a wired input is not passed on, and
counted, as is what the unit's frames say of a wired output."""
import contextlib
import socket
import struct
import sys
import threading
import time
import zlib

UNIT, GENERATOR, PULSES, METER, MODULE, *SUPPLY = map(int, sys.argv[1:])
IO = 2  # channel
INPUT, OUTPUT = 0x01, 0x81
INPUTS = ">HHHHHHHBBBHHBb"
# Bit of the train line, and its coil.
LINES = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (6, 5), (7, 6), (9, 7), (10, 8), (11, 9), (12, 10), (13, 11)]
WIRED = sum(1 << bit for bit, _ in LINES)
MODES = 16  # first coil of the mode switch
CONTACTS = 64  # first input of the module
WIRED_OUTPUTS = 0x7F  # EB relay, FSB, power cut, alarm, holding brake, door enables


class Wires:
    coils = [0] * 24
    carrier = rate = volts = 0.0
    hz = backward = (0.0, 0.0)
    turned = [0.0, 0.0]
    outputs = limit = speed = 0
    supplied = not SUPPLY


def connect(port):
    stream = socket.create_connection(("127.0.0.1", port))
    stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return stream


def instrument(port):
    lines = connect(port).makefile("rw", newline="\n")

    def say(command):
        lines.write(command + "\n")
        lines.flush()

    def ask(question):
        say(question)
        return float(lines.readline())

    return ask, say


def exactly(stream, count):
    read = b""
    while len(read) < count:
        more = stream.recv(count - len(read))
        if not more:
            raise EOFError
        read += more
    return read


def wire():
    (generator, _), (pulses, _), (_, show) = map(instrument, (GENERATOR, PULSES, METER))
    module = connect(MODULE)
    supply = [instrument(port)[0] for port in SUPPLY]

    def modbus(*question):
        module.sendall(bytes([0, 1, 0, 0, 0, len(question) + 1, 1, *question]))
        return exactly(module, exactly(module, 8)[5] - 2)

    while True:
        read = modbus(1, 0, 0, 0, 24)
        Wires.coils = [read[1 + bit // 8] >> bit % 8 & 1 for bit in range(24)]
        Wires.carrier = generator("SOUR1:FREQ?")
        Wires.rate = generator("SOUR1:AM:STAT?") * generator("SOUR1:AM:INT:FREQ?")
        Wires.volts = generator("OUTP1?") * generator("SOUR1:VOLT?")
        Wires.hz = pulses("PULS1:FREQ?"), pulses("PULS2:FREQ?")
        Wires.backward = pulses("PULS1:DIR?"), pulses("PULS2:DIR?")
        modbus(15, 0, CONTACTS, 0, 7, 1, Wires.outputs & WIRED_OUTPUTS)
        Wires.supplied = all(ask("OUTP?") * ask("VOLT?") > 70 for ask in supply)
        # 10 km/h a volt.
        show("SHOW1 %.4f" % (Wires.limit * 0.0036))
        show("SHOW2 %.4f" % (Wires.speed * 0.0036))
        time.sleep(0.002)


def to_unit(payload):
    framed = struct.unpack(INPUTS, payload[1:])
    marker, edges, edge_us, lines, _, controller = framed[8:]
    if framed[:8] != (0,) * 8 or lines & WIRED:
        print("leaked", framed, flush=True)
    lines |= sum(1 << bit for bit, coil in LINES if Wires.coils[coil])
    mode = next((mode for mode in range(6) if Wires.coils[MODES + mode]), 0)
    tachos = []
    for channel in 0, 1:
        hz = Wires.hz[channel]
        # A frame is of a scan, however late it passes here.
        Wires.turned[channel] += hz * 0.01
        turned = Wires.turned[channel]
        tachos += [int(turned) & 0xFFFF, min(65535, int(turned % 1 / hz * 1e6)) if hz else 65535]
    code = (int(Wires.carrier), round(Wires.rate * 100), round(Wires.volts * 1000)) if Wires.volts else (0, 0, 0)
    backward = int(Wires.backward[0]) | int(Wires.backward[1]) << 1
    return payload[:1] + struct.pack(INPUTS, *code, *tachos, backward, marker, edges, edge_us, lines, mode, controller)


def from_unit(payload):
    Wires.outputs, Wires.limit, Wires.speed, marker, count = struct.unpack(">HHHBB", payload[1:])
    return payload[:1] + struct.pack(">HHHBB", Wires.outputs & ~WIRED_OUTPUTS, 0, 0, marker, count)


def stuffed(body):
    return b"\x7e" + body.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e") + b"\x7e"


def carry(source, sink, code, change):
    pending = b""
    while True:
        read = source.recv(4096)
        if not read:
            break
        *frames, pending = (pending + read).split(b"\x7e")
        for frame in filter(None, frames if Wires.supplied else []):
            body = frame.replace(b"\x7d\x5e", b"\x7e").replace(b"\x7d\x5d", b"\x7d")
            if len(body) > 14 and (body[1], body[10]) == (IO, code):
                body = body[:10] + change(body[10:-4])
                body += struct.pack("<I", zlib.crc32(body))
            sink.sendall(stuffed(body))
    sink.shutdown(socket.SHUT_RDWR)


server = socket.create_server(("127.0.0.1", 0))
print(server.getsockname()[1], flush=True)


def until_gone(act, *arguments):
    """An instrument or an end that is gone ends its wiring."""
    with contextlib.suppress(OSError, EOFError, ValueError):
        act(*arguments)


threading.Thread(target=until_gone, args=(wire,), daemon=True).start()
tester, _ = server.accept()
tester.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
unit = connect(UNIT)
threading.Thread(target=until_gone, args=(carry, unit, tester, OUTPUT, from_unit), daemon=True).start()
until_gone(carry, tester, unit, INPUT, to_unit)
