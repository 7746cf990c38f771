#!/usr/bin/env python3
"""Writes the vectors beside it from WIRE.md; see wire.py for the codec.

It knows the wire from that text alone, as a stranger's client would, and takes the check sequence
from zlib: what unit and rig share by mistake, they do not share with this. A field without a value
in VALUES gets bytes that count up, so that a new field needs no change here.
"""

import zlib
from pathlib import Path

from wire import CHANNELS, Wire, closed, fcs, spaced, stuffed

HERE = Path(__file__).parent

# One sample of each message, values far enough apart that two exchanged fields show.
SESSION = 0x0000CAFE
CHALLENGE = 0x12345678
ANSWER = (CHALLENGE ^ 0xFFFFFFFF) ^ SESSION
STATION = {
    "route": 8, "section": 3, "station": 812, "next_station": 813, "loop_id": 8121,
    "fixed_speed_kmh": 255, "running_mode": "recovery", "door_side": "left", "departure": 1,
    "train_number": 8051,
}
VALUES = {
    "ArmRequest": {"session": SESSION},
    "ArmConfirm": {"session": SESSION, "answer": ANSWER},
    "Disarm": {"session": SESSION},
    "KeepAlive": {"session": SESSION},
    "Subscribe": {"changes": 1},
    "TestCode": {"session": SESSION, "carrier_hz": 3000, "code_rate_chz": 1500, "level_mv": 500},
    "TestSpeed": {"session": SESSION, "channels": 3, "backward": 0, "speed_cms": 1944, "accel_mms2": 278},
    "RunSelfTest": {"session": SESSION},
    "TestMarker": {"session": SESSION, "marker": 2},
    "TestTwc": {"session": SESSION, **STATION},
    "TestRelease": {"session": SESSION, "signals": "CODE|SPEED_1|SPEED_2"},
    "ReadLog": {"from_index": 65541},
    "ReadRun": {"from_index": 4801},
    "ReadStored": {"store": "runs", "from_sequence": 70000, "per_cycle": 3},
    "SetClock": {"utc_ms": 1767225600000, "uncertainty_ms": 250},
    "ClearLog": {"session": SESSION},
    "Identity": {
        "serial": "SG-0042", "config": "sg100", "config_crc": 0xDEADBEEF, "tdb_crc": 0x01234567,
        "software": "010203", "uptime_ms": 3600000, "self_test": "TRA|TEST_BOARD",
    },
    "ArmChallenge": {"session": SESSION, "challenge": CHALLENGE},
    "ArmState": {"session": SESSION, "armed": 0, "refusal": "key_off"},
    "StimulusAnswer": {"request_seq": 515, "answer": "out_of_range"},
    "SelfTestItem": {
        "request_seq": 516, "item": "EB_RELAY", "passed": 0, "value": 410, "low": 0, "high": 190,
        "unit": "ms",
    },
    "SelfTestEnd": {"request_seq": 516, "failed": "EB_RELAY", "took_ms": 600},
    "Status": {
        "bits": "TWC_OK|TCMS_OK|TRA_OK|STARTED|INPUTS_OK", "mode": "manual",
        "refusals": "NOT_STANDSTILL|MODE_SWITCH", "code_index": 4, "eb_cause": "none",
        "fsb_cause": "overspeed", "speed1_cms": 1601, "speed2_cms": 1598, "target_cms": 1389,
        "effort": -512, "position_cm": -12345, "events": 17, "rejected_frames": 3,
        "twc_received": 44, "self_test": 0, "test_signals": "CODE", "test_carrier_hz": 3000,
        "test_code_rate_chz": 1500, "test_level_mv": 498, "test_speed_cms": 0,
    },
    "TrainState": {
        "held": 2, "outputs": "EB_RELAY|FSB|POWER_CUT|CODE_VALID|HEALTHY",
        "asked": "POWER_CUT|ALARM|CODE_VALID|HEALTHY", "mode": "manual", "asked_mode": "automatic_run",
        "effort": 0, "asked_effort": 700, "code_index": 4, "eb_cause": "none", "fsb_cause": "overspeed",
        "limit_cms": 1528, "speed_cms": 1640, "train_speed1_cms": 2, "train_speed2_cms": 3,
        "lines": "DOORS_CLOSED|HCR|MAINTENANCE_KEY|EB_LOOP|FORWARD|EB_LOOP_FED", "mode_switch": "manual",
        "controller": -7, "marker": 3, "marker_count": 9, "marker_at_ms": 123450,
        "tcms_bits": "ATO_ENABLE|SERVICE_BRAKE_APPLIED", "tcms_effort": -1024, "load_100kg": 413,
        "twc_station": 812, "twc_section": 61, "twc_loop": 8121, "twc_train_number": 8051, "twc_answers": 44,
        "test_answers": 5, "test_answer_station": 813, "test_answer_train": 8052, "test_pulses": 65000,
        "test_markers": 6,
    },
    "LogEntry": {
        "index": 16, "code": 212, "at_ms": 123456, "parameter": -305, "speed_cms": 1833,
        "limit_cms": 1528, "position_cm": 98765, "mode": "automatic_run", "eb_cause": "overspeed",
    },
    "LogEnd": {"next_index": 17, "oldest_index": 2},
    "RunRow": {
        "index": 4801, "run": 3, "at_ms": 123450, "position_cm": -2, "speed_cms": 1667,
        "target_cms": 1528, "effort": -300, "marker": 2, "ato_state": "run",
    },
    "RunEnd": {"next_index": 4900, "oldest_index": 100},
    "StoredEntry": {
        "sequence": 70001, "power_up": 41, "index": 16, "code": 212, "at_ms": 123456, "parameter": -305,
        "speed_cms": 1833, "limit_cms": 1528, "position_cm": 98765, "mode": "automatic_run",
        "eb_cause": "overspeed",
    },
    "StoredClock": {
        "sequence": 70002, "power_up": 41, "at_ms": 123500, "utc_ms": 1767225600000, "uncertainty_ms": 250,
    },
    "StoredRow": {
        "sequence": 90001, "power_up": 41, "index": 4801, "run": 3, "at_ms": 123450, "position_cm": -2,
        "speed_cms": 1667, "target_cms": 1528, "effort": -300, "marker": 2, "ato_state": "run",
    },
    "StoredEnd": {
        "store": "events", "next_sequence": 70003, "oldest_sequence": 63600, "power_up": 41, "works": 1,
    },
    "IoInput": {
        "carrier_hz": 3000, "code_rate_chz": 1500, "level_mv": 500, "tacho1_count": 65530,
        "tacho1_edge_us": 4321, "tacho2_count": 12, "tacho2_edge_us": 1234, "tacho_backward": 2,
        "marker": 3, "marker_edges": 7, "marker_edge_us": 9876,
        "lines": "DOORS_CLOSED|HCR|EB_LOOP|FORWARD", "mode_switch": "automatic", "controller": -8,
    },
    "IoOutput": {
        "outputs": "EB_RELAY|ALARM|CODE_VALID|HEALTHY", "limit_cms": 1528, "speed_cms": 1545,
        "marker": 3, "marker_count": 9,
    },
    "TcmsToAtc": {"bits": "ATO_ENABLE|SERVICE_BRAKE_APPLIED", "load_100kg": 413, "alive": 200},
    "AtcToTcms": {
        "bits": "POWER|ATO_READY", "mode": "automatic_run", "effort": 1023, "target_cms": 1389,
        "speed_cms": 1201,
    },
    "TwcWayside": STATION,
    "CabEntries": {"train_number": 8052},
    "TwcOrders": {
        "train_number": 8051, "section": 61, "section_length_dm": 8500, "destination": 824, "order": "turn_back",
    },
    "TwcTrain": {
        "answered_seq": 772, "station": 812, "train_number": 8051, "mode": "automatic",
        "bits": "DOORS_CLOSED|STATION_VALID", "speed_cms": 33,
    },
    "TwcReport": {
        "answered_seq": 773, "train_number": 8051, "number_state": "confirmed", "destination": 824,
        "order_state": "turning_back", "received": 4711, "refused": 3, "others": 12,
    },
}


def block(wire, name, seq, stamp, given=None):
    """A vector as text."""
    given = VALUES.get(name, {}) if given is None else given
    payload, parts = wire.payload(name, given)
    body = wire.body(name, seq, stamp, given)
    lines = [f"message {name}"]
    lines += [f"header  {n:20} {v!s:44} {spaced(b)}" for n, v, b in wire.header(name, seq, stamp)]
    lines += [f"code    {'':20} 0x{payload[0]:02x}{'':40} {payload[0]:02x}"]
    lines += [f"field   {n:20} {v!s:44} {spaced(b)}" for n, v, b in parts]
    lines += [f"fcs     {'':20} 0x{zlib.crc32(body):08x}{'':34} {spaced(fcs(body))}"]
    lines += [f"frame   {spaced(closed(body))}"]
    return "\n".join(lines) + "\n"


def messages(wire, channel):
    own = [name for name, entry in wire.messages.items() if entry[0] == channel]
    blocks = [f"# Channel {channel}: every message, with a value in every field.\n"]
    for i, name in enumerate(own):
        blocks.append(block(wire, name, 0x0102 + 0x0101 * i, 0x00010203 + 0x01010101 * i))
    return "\n".join(blocks)


def escapes(wire):
    """Flags and escapes in every part of a frame; those in the FCS are found by trying."""
    code = {"session": 0x7E7D7D7E, "carrier_hz": 0x7D7E, "code_rate_chz": 0x5E7D, "level_mv": 0x7E20}
    blocks = [
        "# 7e and 7d in header, payload and FCS.\n",
        "# In sequence number and time stamp.\n" + block(wire, "Identify", 0x7E7D, 0x7D5E7E5D),
        "# In the payload, twice the same, and next to bytes that look like escaped ones.\n"
        + block(wire, "TestCode", 1, 1000, code),
    ]
    keep = lambda seq: fcs(wire.body("KeepAlive", seq, 5000, VALUES["KeepAlive"]))
    for place in range(4):
        for special in (0x7E, 0x7D):
            seq = next(s for s in range(65536) if keep(s)[place] == special)
            note = f"# {special:02x} as FCS byte {place + 1} of 4.\n"
            blocks.append(note + block(wire, "KeepAlive", seq, 5000))
    seq = next(s for s in range(65536) if sum(b in b"\x7d\x7e" for b in keep(s)) >= 2)
    blocks.append("# In two of the four FCS bytes.\n" + block(wire, "KeepAlive", seq, 5000))
    return "\n".join(blocks)


def checks():
    texts = [b"123456789", b"", b"\0", b"\0\0\0\0", b"\xff\xff\xff\xff", b"~}", bytes(range(254))]
    lines = ["# Bytes and their FCS as a number; `-` is no bytes at all."]
    lines += [f"0x{zlib.crc32(text):08x}  {spaced(text) or '-'}" for text in texts]
    return "\n".join(lines) + "\n"


def bad(wire):
    """Cases of frames that must be refused, each with its reason."""
    one = lambda seq=1, stamp=1000, name="Identify": wire.frame(name, seq, stamp, VALUES.get(name, {}))
    raw = lambda seq=1, stamp=1000: wire.body("Identify", seq, stamp, {})

    def patched(offset, value, seq=1):
        data = bytearray(raw(seq))
        data[offset] = value
        return closed(bytes(data))

    good = one()
    ok = "accept Identify"
    cases = [
        ("An ordinary frame, to begin with", [(0, ok, good)]),
        ("Flags alone are no frames", [(0, "nothing", b"\x7e" * 9)]),
        ("One flag between two frames", [(0, f"{ok},{ok}", one(1) + one(2)[1:])]),
        ("Four bytes between flags", [(0, "reject too_short", b"\x7e\x01\x02\x03\x04\x7e")]),
        ("13 bytes with a right FCS", [(0, "reject too_short", closed(raw()[:9]))]),
        ("Header and FCS right, no payload", [(0, "reject layout", closed(raw()[:10]))]),
        ("254 bytes, which is not too long, but no message",
         [(0, "reject layout", closed(raw() + bytes(239)))]),
        ("255 bytes with a right FCS; the last is garbage",
         [(0, "reject too_long", closed(raw() + b"a" * 240))], "garbage 1"),
        ("255 bytes, the last of them escaped",
         [(0, "reject too_long", stuffed(raw() + b"a" * 243 + b"~"))]),
        ("254 bytes, then an abort", [(0, "reject escape", stuffed(raw() + b"a" * 243)[:-1] + b"\x7d\x7e")]),
        ("One bit wrong in the payload", [(0, "reject checksum", flipped(good, 11, 0x10))]),
        ("One bit wrong in the FCS", [(0, "reject checksum", flipped(good, 13, 0x01))]),
        ("FCS most significant octet first",
         [(0, "reject checksum", stuffed(raw() + fcs(raw())[::-1]))]),
        ("FCS not complemented",
         [(0, "reject checksum", stuffed(raw() + bytes(b ^ 0xFF for b in fcs(raw()))))]),
        ("FCS over the stuffed bytes", [(0, "reject checksum", fcs_over_stuffed(wire))]),
        ("One byte missing", [(0, "reject checksum", good[:6] + good[7:])]),
        ("Cut off, then a good one; one opening flag ends the first",
         [(0, "nothing", good[:-4]), (5, f"reject too_short,{ok}", one(2, 1005))]),
        ("Closing flag lost; the next frame's opening flag stands for it",
         [(0, "nothing", good[:-1]), (5, f"{ok},{ok}", one(2, 1005))]),
        ("Version 2", [(0, "reject version", patched(0, 2))]),
        ("Version 0", [(0, "reject version", patched(0, 0))]),
        ("Channel 0", [(0, "reject channel", patched(1, 0))]),
        ("Channel 5", [(0, "reject channel", patched(1, 5))]),
        ("From an unknown address", [(0, "reject address", patched(2, 0x11))]),
        ("To an unknown address", [(0, "reject address", patched(3, 0x00))]),
        ("To the bench, heard by the unit", [(0, "reject address", patched(3, 0x10))]),
        ("From the I/O rack on the PTU channel", [(0, "reject address", patched(2, 0x30))]),
        ("The unit's own frame, echoed",
         [(0, "reject address", one(name="ArmState"))]),
        ("The unit's own message under the tester's addresses",
         [(0, "reject layout", closed(raw()[:10] + wire.payload("ArmState", {})[0]))]),
        ("Aborted", [(0, "reject escape", good[:8] + b"\x7d\x7e")]),
        ("An escape of a byte that is never escaped",
         [(0, "reject escape", good[:2] + b"\x7d" + bytes([good[2] ^ 0x20]) + good[3:])],
         f"garbage {len(good) - 4}"),
        ("An escape of an escape", [(0, "reject escape", good[:8] + b"\x7d\x7d\x5d" + good[8:])],
         f"garbage {len(good) - 8}"),
        ("Unknown message code", [(0, "reject layout", patched(10, 0x7F))]),
        ("One byte too few for the message",
         [(0, "reject layout", closed(wire.body("TestMarker", 1, 1000, {})[:-1]))]),
        ("One byte too many for the message", [(0, "reject layout", closed(raw() + b"\0"))]),
        ("The same frame twice", [(0, ok, good), (10, "reject sequence", good)]),
        ("Two frames exchanged",
         [(0, ok, good), (10, ok, one(3, 1010)), (10, "reject sequence", one(2, 1005))], "gaps 1"),
        ("1000 ahead is the most", [(0, ok, good), (10, ok, one(1001, 1010))], "gaps 999"),
        ("1001 ahead", [(0, ok, good), (10, "reject sequence", one(1002, 1010))]),
        ("The sequence number wraps", [(0, ok, one(65535)), (10, ok, one(0, 1010))]),
        ("An old frame across the wrap", [(0, ok, one(0)), (10, "reject sequence", one(65535, 1010))]),
        ("The time stamp goes backward by 1 ms", [(0, ok, good), (10, "reject stamp", one(2, 999))]),
        ("The same time stamp is no fault", [(0, ok, good), (10, ok, one(2, 1000))]),
        ("The time stamp wraps", [(0, ok, one(1, 0xFFFFFFFF)), (10, ok, one(2, 9))]),
        ("500 ms late is not too late", [(0, ok, good), (700, ok, one(2, 1200))]),
        ("501 ms late", [(0, ok, good), (701, "reject stamp", one(2, 1200))]),
        ("The quickest way counts, also when the first frame was slow",
         [(400, ok, good), (500, ok, one(2, 1500)), (1101, "reject stamp", one(3, 1600)),
          (1102, ok, one(4, 1602))], "gaps 1"),
        ("A late frame long ago is no excuse for a late one now",
         [(0, ok, good), (701, "reject stamp", one(2, 1200)), (710, ok, one(3, 1710)),
          (3000, "reject stamp", one(4, 1800))]),
        ("A line blocked for 3 s delivers old frames in one burst, then a new one",
         [(0, ok, good), (3000, "reject stamp,reject stamp", one(2, 1100) + one(3, 2400)),
          (3010, ok, one(4, 4000))], "gaps 2"),
        ("A sender whose clock stood still is taken again after 1 s",
         [(0, ok, good), (3000, "reject stamp", one(2, 1500)), (3500, "reject stamp", one(3, 2000)),
          (4000, ok, one(4, 2500)), (4010, ok, one(5, 2510))]),
        ("A restarted sender is refused at first, and taken after 1 s of silence",
         [(0, ok, one(500, 60000)), (999, "reject sequence", one(0, 100)), (1000, ok, one(1, 101))]),
        ("Refused frames do not feed the time-out",
         [(0, ok, one(500)), (400, "reject sequence", one(500)), (800, "reject sequence", one(500)),
          (1000, ok, one(7, 5))]),
        ("Noise before a frame", [(0, ok, b"\x00\xff\x55\x7d\x5e\x41" + good)], "garbage 6"),
        ("Noise between two frames counts as a frame, for it stands between flags",
         [(0, f"{ok},reject too_short,{ok}", good + b"\x00\xff\x55" + one(2))]),
        ("A channel that is refused leaves the others alone",
         [(0, ok, good), (10, "reject sequence,accept TcmsToAtc",
                          good + one(1, 1010, "TcmsToAtc"))]),
        ("The bench hears the unit", [(0, "accept ArmState", one(name="ArmState"))], "end bench"),
        ("The bench does not hear itself", [(0, "reject address", good)], "end bench"),
    ]
    blocks = ["# Frames that must be refused, and some that must not; WIRE.md, section 12, says how to read this.\n"]
    for what, feeds, *more in cases:
        lines = [f"case {what}"] + more
        lines += [f"{at:<5} {outcome:32}  {spaced(data)}" for at, outcome, data in feeds]
        blocks.append("\n".join(lines) + "\n")
    return "\n".join(blocks)


def flipped(data, offset, mask):
    return data[:offset] + bytes([data[offset] ^ mask]) + data[offset + 1:]


def fcs_over_stuffed(wire):
    body = wire.body("Identify", 0x7E7E, 1000, {})
    inner = stuffed(body)[1:-1]
    return stuffed(body + fcs(inner))


RACK = {
    "carrier_hz": 0, "code_rate_chz": 0, "level_mv": 0, "tacho1_count": 0, "tacho1_edge_us": 65535,
    "tacho2_count": 0, "tacho2_edge_us": 65535, "tacho_backward": 0, "marker": 0,
    "marker_edges": 0, "marker_edge_us": 65535,
    "lines": "DOORS_CLOSED|HCR|MAINTENANCE_KEY|FORWARD|EB_LOOP_FED", "mode_switch": "manual", "controller": 0,
}
# TCMS orders the full service brake as long as the unit asks for it.
BRAKING = {"bits": "FULL_SERVICE_BRAKE", "load_100kg": 0, "alive": 1, "effort": 0, "speed_cms": 0}
STANDING = {
    "bits": "TCMS_OK|TRA_OK|ATO_READY|STARTED|INPUTS_OK", "mode": "manual", "ato_state": "stop",
    "refusals": "NO_TWC|STATION_INVALID|NO_CODE|MODE_SWITCH|TCMS_NOT_READY|NO_DEPARTURE",
    "code_index": 255, "eb_cause": "none", "fsb_cause": "no_code", "events": 3,
}
CODED = {
    **STANDING, "bits": "ARMED|TCMS_OK|TRA_OK|ATO_READY|STARTED|INPUTS_OK",
    "refusals": "NO_TWC|STATION_INVALID|MODE_SWITCH|TCMS_NOT_READY|NO_DEPARTURE", "code_index": 4,
    "fsb_cause": "none", "events": 4, "test_signals": "CODE", "test_carrier_hz": 3000,
    "test_code_rate_chz": 1500, "test_level_mv": 500,
}
ARM = [
    (f"Arm, session 0x{SESSION:08X}.", 110, ">", "ArmRequest", None),
    (f"Challenge 0x{CHALLENGE:08X}.", 150, "<", "ArmChallenge", None),
    (f"Its complement, exclusive-or the session: 0x{ANSWER:08X}.", 160, ">", "ArmConfirm", None),
    ("Armed.", 200, "<", "ArmState", {"session": SESSION, "armed": 1, "refusal": "none"}),
    ("3000 Hz with 15.00 Hz at 500 mV into the test coil.", 210, ">", "TestCode", None),
]


def rack(*lines):
    """Inputs with these lines beside those that are always on."""
    return {**RACK, "lines": "|".join((RACK["lines"], *lines))}


def session(wire):
    """The worked session of WIRE.md."""
    output = {"outputs": "EB_RELAY|FSB|POWER_CUT|CODE_VALID|STANDSTILL|HEALTHY", "limit_cms": 1528}
    return conversation(wire, [
        ("The I/O rack holds the maintenance key on; nothing in the antenna, no tachometer pulse.",
         0, ">", "IoInput", RACK),
        ("TCMS orders the full service brake: without a code the unit asks for it.", 0, ">", "TcmsToAtc", BRAKING),
        ("Listen.", 0, ">", "KeepAlive", {"session": 0}),
        ("The cab is active and the train stands: the brake is released, and the line goes with it.",
         60, ">", "IoInput", rack("EB_LOOP")),
        ("Status, every 50 ms: STARTED is set, so the self-test is over.", 100, "<", "Status", STANDING),
        ("Who are you?", 100, ">", "Identify", None),
        ("The unit says who it is.", 110, "<", "Identity", {**VALUES["Identity"], "self_test": 0}),
        *ARM,
        ("Request 4 (sequence number of the frame above) is accepted.", 250, "<", "StimulusAnswer",
         {"request_seq": 4, "answer": "accepted"}),
        ("Stay armed.", 500, ">", "KeepAlive", None),
        ("Code 4 of the table is received, the board reads back what it makes.", 850, "<", "Status", CODED),
        ("Limit 1528 cm/s = 55 km/h. FSB is held while armed; TCMS says that it brakes, so EB_RELAY is on.",
         860, "<", "IoOutput", output),
        ("Take the test code away.", 900, ">", "TestRelease", {"session": SESSION, "signals": "CODE"}),
        ("Request 6 is accepted.", 950, "<", "StimulusAnswer", {"request_seq": 6, "answer": "accepted"}),
        ("Leave.", 960, ">", "Disarm", None),
        ("No longer armed.", 1000, "<", "ArmState", {"session": SESSION, "armed": 0, "refusal": "disarmed"}),
    ])


def overspeed(wire):
    """Overspeed, emergency brake and release of WIRE.md."""
    speed = lambda cms: {"session": SESSION, "channels": 3, "backward": 0, "speed_cms": cms, "accel_mms2": 0}
    output = lambda outputs, cms: {"outputs": outputs, "limit_cms": 1528, "speed_cms": cms}
    entry = lambda index, code, parameter, cms, cause: {
        "index": index, "code": code, "at_ms": 0, "parameter": parameter, "speed_cms": cms, "limit_cms": 1528,
        "mode": "manual", "eb_cause": cause}
    return conversation(wire, [
        ("The I/O rack as in the first session.", 0, ">", "IoInput", RACK),
        ("So does TCMS.", 0, ">", "TcmsToAtc", BRAKING),
        ("Listen.", 0, ">", "KeepAlive", {"session": 0}),
        ("The brake is released by itself: the unit stands, and nothing but start-up held it.",
         60, "<", "IoOutput", {"outputs": "EB_RELAY|FSB|POWER_CUT|STANDSTILL|HEALTHY"}),
        ("The brake line follows the relay.", 60, ">", "IoInput", rack("EB_LOOP")),
        *ARM,
        ("Stay armed: from here on every 500 ms.", 500, ">", "KeepAlive", None),
        ("Limit 1528 cm/s; the full service brake is held.", 1000, "<", "IoOutput", output("EB_RELAY|FSB|POWER_CUT|CODE_VALID|STANDSTILL|HEALTHY", 0)),
        ("1580 cm/s on both tachometers, at the board's own 3000 mm/s²: above the alarm margin.",
         1000, ">", "TestSpeed", speed(1580)),
        ("The alarm sounds.", 7000, "<", "IoOutput", output("EB_RELAY|FSB|POWER_CUT|ALARM|CODE_VALID|HEALTHY", 1580)),
        ("1640 cm/s: above the margin of the full service brake.", 7000, ">", "TestSpeed", speed(1640)),
        ("That the unit would ask for the full service brake now shows in its cause alone.", 8000, "<", "Status", {
            **CODED, "refusals": "NOT_STANDSTILL|NO_TWC|STATION_INVALID|MODE_SWITCH|TCMS_NOT_READY|NO_DEPARTURE",
            "fsb_cause": "overspeed", "speed1_cms": 1640, "speed2_cms": 1640,
            "events": 6, "test_signals": "CODE|SPEED_1|SPEED_2", "test_speed_cms": 1640}),
        ("1750 cm/s: above the emergency margin.", 8000, ">", "TestSpeed", speed(1750)),
        ("EB_RELAY is off: the emergency brake.", 9000, "<", "IoOutput",
         output("FSB|POWER_CUT|ALARM|CODE_VALID|HEALTHY", 1750)),
        ("The brake line follows.", 9000, ">", "IoInput", rack()),
        ("Its cause.", 9050, "<", "Status", {
            **CODED, "refusals": "NOT_STANDSTILL|NO_TWC|STATION_INVALID|MODE_SWITCH|EB_APPLIED|TCMS_NOT_READY|NO_DEPARTURE",
            "eb_cause": "overspeed", "fsb_cause": "overspeed", "speed1_cms": 1750, "speed2_cms": 1750,
            "events": 7, "test_signals": "CODE|SPEED_1|SPEED_2", "test_speed_cms": 1750}),
        ("The button under way is refused, and the refusal logged.", 9100, ">", "IoInput", rack("ACKNOWLEDGE")),
        ("Still braking.", 9600, "<", "IoOutput", output("FSB|POWER_CUT|ALARM|CODE_VALID|HEALTHY", 1750)),
        ("Let it go.", 9600, ">", "IoInput", rack()),
        ("Stop.", 9700, ">", "TestSpeed", speed(0)),
        ("STANDSTILL is set, the alarm is silent, the emergency brake stays.", 17000, "<", "IoOutput",
         output("FSB|POWER_CUT|CODE_VALID|STANDSTILL|HEALTHY", 0)),
        ("Acknowledge.", 17000, ">", "IoInput", rack("ACKNOWLEDGE")),
        ("EB_RELAY is on: the emergency brake is released.", 17050, "<", "IoOutput",
         output("EB_RELAY|FSB|POWER_CUT|CODE_VALID|STANDSTILL|HEALTHY", 0)),
        ("The brake line follows, the button is let go.", 17060, ">", "IoInput", rack("EB_LOOP")),
        ("No cause.", 17200, "<", "Status", {
            **CODED, "events": 9, "test_signals": "CODE|SPEED_1|SPEED_2"}),
        ("What is in the log from entry 6 on?", 17200, ">", "ReadLog", {"from_index": 6}),
        ("Event 212, the emergency brake, 220 cm/s above the limit.", 17250, "<", "LogEntry",
         entry(6, 212, 220, 1747, "none")),
        ("Event 216, the refusal: its cause, 2, still held.", 17250, "<", "LogEntry",
         entry(7, 216, 2, 1750, "overspeed")),
        ("Event 214, its release.", 17300, "<", "LogEntry", entry(8, 214, 0, 0, "overspeed")),
        ("The end.", 17300, "<", "LogEnd", {"next_index": 9, "oldest_index": 0}),
        ("Take all test signals away.", 17500, ">", "TestRelease",
         {"session": SESSION, "signals": "CODE|SPEED_1|SPEED_2"}),
        ("Leave.", 17600, ">", "Disarm", None),
        ("No longer armed.", 17650, "<", "ArmState", {"session": SESSION, "armed": 0, "refusal": "disarmed"}),
    ])


def conversation(wire, steps):
    """Steps (note, ms, way, message, values) as frames."""
    boot = {">": 4660, "<": 90000}  # each side's own clock at time 0
    seqs, lines = {}, []
    for note, at, way, name, given in steps:
        key = (way, wire.messages[name][0])
        seq = seqs[key] = seqs.get(key, -1) + 1
        given = {**wire.zeros(name), **(VALUES.get(name, {}) if given is None else given)}
        data = spaced(wire.frame(name, seq, boot[way] + at, given))
        lines += [f"# {note}", f"{at:<5} {way} {name:14} {data}"]
    return "\n".join(lines) + "\n"


def example(wire):
    body = wire.body("Identify", 0, 0x1234, {})
    rows = [("version", 0, 1), ("channel PTU", 1, 2), ("from the tester", 2, 3), ("to the unit", 3, 4),
            ("sequence number 0", 4, 6), ("time stamp 4660 ms", 6, 10), ("code of Identify", 10, 11)]
    lines = [f"{spaced(body[a:b]):40} {what}" for what, a, b in rows]
    lines.append(f"{spaced(fcs(body)):40} FCS 0x{zlib.crc32(body):08X}, least significant octet first")
    lines.append("")
    lines.append(spaced(closed(body)))
    return "\n".join(lines) + "\n"


def main():
    wire = Wire((HERE.parent / "WIRE.md").read_text(encoding="utf-8"))
    files = {f"{channel}.hex": messages(wire, channel) for channel in CHANNELS}
    files |= {"escapes.hex": escapes(wire), "fcs.hex": checks(), "bad.hex": bad(wire),
              "session.hex": session(wire),
              "overspeed.hex": overspeed(wire), "example.txt": example(wire)}
    for name, text in files.items():
        (HERE / name).write_text(text, encoding="utf-8")


main()
