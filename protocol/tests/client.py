#!/usr/bin/env python3
"""Arms an on-board ATC unit over a pseudo terminal, feeds a speed code into its test coil and
checks the limit; if asked, drives it into overspeed and releases the emergency brake that follows, or
gives it orders as the wayside does and keys in a train number at its cab.
Written from WIRE.md alone, to show that the text is enough."""
import argparse, collections, contextlib, os, random, re, select, struct, sys, time, tty, zlib

UNIT, PTU, IO, TCMS, TWC = 0x20, 1, 2, 3, 4
PARTNER = {PTU: 0x10, IO: 0x30, TCMS: 0x40, TWC: 0x50}                             # channel: address
DOORS_CLOSED, HCR, MAINTENANCE_KEY, ACKNOWLEDGE, EB_LOOP, FORWARD = 0x01, 0x02, 0x04, 0x08, 0x20, 0x40
EB_LOOP_FED = 0x100
SERVICE_BRAKED, EMERGENCY_BRAKED = 0x44, 0x08     # FULL_SERVICE_BRAKE with SERVICE_BRAKE_APPLIED; EMERGENCY_BRAKE_APPLIED
EB_RELAY, FSB, ALARM, CODE_VALID, STANDSTILL = 0x001, 0x002, 0x008, 0x080, 0x100
ARMED, UP, MANUAL = 0x001, 0x180, 2                                     # UP: STARTED and INPUTS_OK
EB_OVERSPEED, FSB_OVERSPEED = 2, 1
SCAN_END = b"\x7e" * 3
NO_ORDER, TURN_BACK, IDLE, KEYED, CONFIRMED = 0, 1, 0, 1, 2
ANSWERS = dict(enumerate("accepted not_armed out_of_range board_failed".split()))
REFUSALS = dict(enumerate("none key_off moving bad_answer busy tester_silent disarmed starting_up brakes_released "
                          "train_moved code_changed mode_changed".split()))
FROM_UNIT = {                               # the fields that are used here; x = a byte passed over
    (PTU, 0x81): ("Identity", ">16s24x3s4xH", "serial software self_test"),
    (PTU, 0x82): ("ArmChallenge", ">II", "session challenge"),
    (PTU, 0x83): ("ArmState", ">IBB", "session armed refusal"),
    (PTU, 0x84): ("StimulusAnswer", ">HB", "request_seq answer"),
    (PTU, 0x90): ("Status", ">H3xBBB11xxI19x", "bits code_index eb_cause fsb_cause events"),
    (PTU, 0xA0): ("LogEntry", ">IH4xi10x", "index code parameter"),
    (PTU, 0xA1): ("LogEnd", ">II", "next_index oldest_index"),
    (IO, 0x81): ("IoOutput", ">HH4x", "outputs limit_cms"),
    (TCMS, 0x81): ("AtcToTcms", ">9x", ""),
    (TWC, 0x82): ("TwcReport", ">HHBHBHHH",
                  "answered_seq train_number number_state destination order_state received refused others")}

class Client:
    def __init__(self, path, lines, lock_step):
        self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY | (0 if lock_step else os.O_NONBLOCK))
        tty.setraw(self.fd)
        self.scans = 0 if lock_step else None                           # since the first, in lock step
        self.lines, self.session = lines, 0                             # session 0 only listens
        self.next_seq, self.due = dict.fromkeys(PARTNER, 0), dict.fromkeys(PARTNER, 0.0)
        self.alive, self.orders, self.keyed = 0, None, None             # orders: train number and order
        self.log = []                       # entries as they came
        self.last, self.heard = {}, {}      # channel: (sequence, time); name: its newest message
        self.bytes, self.refused = b"", 0   # bytes since the last flag; number of frames

    def now(self):
        """Seconds: in lock step the clock moves with the scans alone."""
        return time.monotonic() if self.scans is None else self.scans * 0.010

    def send(self, channel, layout, *fields):
        seq, self.next_seq[channel] = self.next_seq[channel], (self.next_seq[channel] + 1) & 0xFFFF
        stamp = int(self.now() * 1000) & 0xFFFFFFFF
        body = struct.pack(">BBBBHI" + layout, 1, channel, PARTNER[channel], UNIT, seq, stamp, *fields)
        body += struct.pack("<I", zlib.crc32(body))
        body = body.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e")
        with contextlib.suppress(BlockingIOError):                      # nobody reads: a lost frame
            os.write(self.fd, b"\x7e" + body + b"\x7e")
        return seq

    def keep_sending(self):
        now = self.now()
        if now >= self.due[IO]:             # nothing in the antenna, no pulse, no marker
            self.due[IO] = now + 0.020
            released = "IoOutput" in self.heard and self.heard["IoOutput"].outputs & EB_RELAY
            if self.keyed is not None:
                self.send(IO, "BH", 0x02, self.keyed)
            self.send(IO, "B7H3B2HBb", 0x01, 0, 0, 0, 0, 0xFFFF, 0, 0xFFFF, 0, 0, 0, 0xFFFF,
                      self.lines | (EB_LOOP if released else 0), MANUAL, 0)
        if now >= self.due[TCMS]:           # the train brakes as the unit asks, and says so
            self.due[TCMS] = now + 0.050
            self.alive = (self.alive + 1) & 0xFF
            contacts = self.heard["IoOutput"].outputs if "IoOutput" in self.heard else 0
            brakes = (SERVICE_BRAKED if contacts & FSB else 0) | (0 if contacts & EB_RELAY else EMERGENCY_BRAKED)
            self.send(TCMS, "BHHBhH", 0x01, brakes, 0, self.alive, 0, 0)
        if self.orders and now >= self.due[TWC]:
            self.due[TWC] = now + 0.250
            self.send(TWC, "BHHIHB", 0x02, self.orders[0], 0, 0, 0, self.orders[1])
        if now >= self.due[PTU]:
            self.due[PTU] = now + 0.400
            self.send(PTU, "BI", 0x05, self.session)

    def receive(self):
        if self.scans is not None:          # this scan is over; the unit's follows, and its end
            os.write(self.fd, SCAN_END)
            self.scans += 1
            heard = b""
            while not heard.endswith(SCAN_END):
                heard += os.read(self.fd, 4096)
            self.take(heard)
        elif select.select([self.fd], [], [], 0.005)[0]:
            self.take(os.read(self.fd, 4096))

    def take(self, heard):
        *frames, self.bytes = (self.bytes + heard).split(b"\x7e")
        for stuffed in filter(None, frames):
            self.refused += not self.accept(stuffed)

    def accept(self, stuffed):
        """Takes what stood between two flags, unless it must be refused."""
        body = stuffed.replace(b"\x7d\x5e", b"\x7e").replace(b"\x7d\x5d", b"\x7d")
        if re.search(rb"\x7d(?![\x5d\x5e])", stuffed) or not 14 < len(body) <= 254:
            return False                    # escape, too_long, too_short
        if zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
            return False                    # checksum
        version, channel, source, target, seq, _, code = struct.unpack(">BBBBHIB", body[:11])
        name, layout, fields = FROM_UNIT.get((channel, code), ("", "255x", ""))
        if (version, source, target, struct.calcsize(layout)) != (1, UNIT, PARTNER.get(channel), len(body) - 15):
            return False                    # version, channel, address, layout
        last, at = self.last.get(channel, (0, 0.0))
        if self.now() < at + 1 and not 1 <= (seq - last) & 0xFFFF <= 1000:
            return False                    # sequence
        self.last[channel] = seq, self.now()
        self.heard[name] = collections.namedtuple(name, fields)(*struct.unpack(layout, body[11:-4]))
        self.log += [self.heard[name]] if name == "LogEntry" else []
        return True

    def wait(self, what, name, fits=lambda message: True):
        """Keeps the line going until a message of this name was heard that fits."""
        end = self.now() + 10
        while name not in self.heard or not fits(self.heard[name]):
            state = self.heard.get("ArmState")
            if state and not state.armed:
                sys.exit(f"failed: not armed: {REFUSALS.get(state.refusal, state.refusal)}")
            if self.now() > end:
                sys.exit(f"failed: no {what} within 10 s")
            self.keep_sending()
            self.receive()
        return self.heard[name]

    def ask(self, answer, layout, *fields):
        """Sends a request of the tester; gives its sequence number and the answer."""
        self.heard.pop(answer, None)
        return self.send(PTU, layout, *fields), self.wait(answer, answer)

    def wait_for(self, outputs, off=0):
        """Waits until these outputs are on and those are off."""
        return self.wait(f"outputs 0x{outputs:03x} on and 0x{off:03x} off", "IoOutput",
                         lambda output: output.outputs & outputs == outputs and not output.outputs & off)

    def stimulate(self, what, layout, *fields):
        """Sends a stimulus, which must be accepted."""
        seq, given = self.ask("StimulusAnswer", layout, *fields)
        if (given.request_seq, given.answer) != (seq, 0):
            sys.exit(f"failed: {what} {seq}: {ANSWERS.get(given.answer, given.answer)}, {given}")

    def idle(self, seconds):
        end = self.now() + seconds
        while self.now() < end:
            self.keep_sending()
            self.receive()

def overspeed(client, session, speed):
    """Drives into the emergency brake, and releases it."""
    begin = client.wait("Status", "Status").events
    client.wait_for(EB_RELAY)
    print("emergency brake released: the unit stands")
    client.stimulate("TestSpeed", "BIBBHH", 0x11, session, 3, 0, speed, 0)
    client.wait_for(ALARM | FSB | EB_RELAY)     # the service brake is held while armed
    client.wait("cause of the service brake", "Status", lambda status: status.fsb_cause == FSB_OVERSPEED)
    client.wait_for(ALARM | FSB, off=EB_RELAY)
    client.wait("cause of the emergency brake", "Status", lambda status: status.eb_cause == EB_OVERSPEED)
    print(f"overspeed at {speed} cm/s: alarm, full service brake, emergency brake")
    client.lines |= ACKNOWLEDGE
    client.idle(0.5)
    client.lines &= ~ACKNOWLEDGE
    client.idle(0.1)
    client.wait_for(0, off=EB_RELAY | STANDSTILL)
    client.stimulate("TestSpeed", "BIBBHH", 0x11, session, 3, 0, 0, 0)
    client.wait_for(STANDSTILL, off=ALARM | EB_RELAY)
    print("standing; acknowledged under way, the emergency brake stays")
    client.lines |= ACKNOWLEDGE
    client.wait_for(EB_RELAY)
    client.lines &= ~ACKNOWLEDGE
    client.wait("no cause", "Status", lambda status: status.eb_cause == 0)
    client.log.clear()
    client.ask("LogEnd", "BI", 0x20, begin)
    codes = [entry.code for entry in client.log]
    excess = next((entry.parameter for entry in client.log if entry.code == 212), 0)
    print(f"acknowledged: emergency brake released; events {codes}, excess {excess} cm/s")
    if codes != [210, 211, 212, 216, 214] or not 0 < excess <= speed:
        sys.exit("failed: events 210, 211, 212 with its excess, 216 (refused under way) and 214 were expected")
    client.stimulate("TestRelease", "BIH", 0x14, session, 0x000F)

def order(client):
    """Is the wayside: orders what the train is not in the state for, and renames it at the cab."""
    begin = client.wait("Status", "Status").events
    client.orders = 0, NO_ORDER
    own = client.wait("an answer to orders", "TwcReport").train_number
    client.wait("orders for another train passed over", "TwcReport", lambda report: report.others)
    client.orders = own, TURN_BACK
    client.wait("orders taken", "TwcReport", lambda report: report.received)
    client.log.clear()
    client.ask("LogEnd", "BI", 0x20, begin)
    codes = [entry.code for entry in client.log]
    state = client.heard["TwcReport"].order_state
    print(f"train {own}: turn-back away from a destination refused; state {state}, events {codes}")
    if state != IDLE or not {409, 413} <= set(codes):
        sys.exit("failed: state 0, and events 409 (another train) and 413 (order refused) were expected")
    client.orders, client.keyed = (own, NO_ORDER), own + 1
    client.wait("number keyed in", "TwcReport",
                lambda report: (report.train_number, report.number_state) == (own + 1, KEYED))
    client.orders, client.keyed = (own + 1, NO_ORDER), None
    client.wait("number confirmed", "TwcReport", lambda report: report.number_state == CONFIRMED)
    print(f"train {own + 1} keyed in at the cab and confirmed")

def run(client, carrier, rate, level, limit, speed, orders):
    quiet = client.now() + 1.1          # after 1 s of silence every channel begins anew
    while client.now() < quiet:
        client.receive()
    client.heard.clear()
    client.wait("end of start-up", "Status", lambda status: status.bits & UP == UP)
    _, unit = client.ask("Identity", "B", 0x01)
    print(f"start-up is done: unit {unit.serial.decode('ascii', 'replace').strip(chr(0))}, "
          f"software {'.'.join(map(str, unit.software))}, failed self-tests 0x{unit.self_test:04x}")
    if orders:
        return order(client)
    client.session = session = random.randrange(1, 1 << 32)
    _, asked = client.ask("ArmChallenge", "BI", 0x02, session)
    client.ask("ArmState", "BII", 0x03, session, asked.challenge ^ 0xFFFFFFFF ^ session)
    client.wait("Status with ARMED", "Status", lambda status: status.bits & ARMED)
    print(f"armed; limit without a code {client.wait('IoOutput', 'IoOutput').limit_cms} cm/s")
    client.stimulate("TestCode", "BI3H", 0x10, session, carrier, rate, level)
    print(f"TestCode accepted: carrier {carrier} Hz, code rate {rate / 100:.2f} Hz, level {level} mV")
    client.wait(f"limit of {limit} cm/s", "IoOutput",
                lambda output: output.outputs & CODE_VALID and output.limit_cms == limit)
    status = client.wait("code in Status", "Status", lambda status: status.code_index != 255)
    print(f"limit {limit} cm/s = {limit * 0.036:.0f} km/h, code {status.code_index} of the table")
    if speed:
        overspeed(client, session, speed)
    _, state = client.ask("ArmState", "BI", 0x04, session)
    if state.armed or REFUSALS.get(state.refusal) != "disarmed":
        sys.exit(f"failed: Disarm answered by {state}")
    print(f"disarmed; frames refused here: {client.refused}")

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pty")
    parser.add_argument("--code", nargs=4, type=int, default=[3000, 1500, 500, 1528],
                        metavar=("HZ", "CHZ", "MV", "CM/S"), help="carrier, rate, level, expected limit")
    parser.add_argument("--overspeed", type=int, default=0, metavar="CM/S",
                        help="a speed beyond the emergency margin")
    parser.add_argument("--orders", action="store_true", help="gives orders in place of test signals")
    parser.add_argument("--no-key", dest="key", action="store_const", const=0, default=MAINTENANCE_KEY)
    parser.add_argument("--lock-step", action="store_true", help="the unit scans when this does, not by the clock")
    options = parser.parse_args()
    try:
        run(Client(options.pty, DOORS_CLOSED | HCR | FORWARD | EB_LOOP_FED | options.key, options.lock_step), *options.code,
            options.overspeed, options.orders)
    except (OSError, struct.error) as error:
        sys.exit(f"failed: {error}")
