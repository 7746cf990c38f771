"""Frames from the tables of WIRE.md."""

import re
import zlib

CHANNELS = {"ptu": (1, 0x10), "io": (2, 0x30), "tcms": (3, 0x40), "twc": (4, 0x50)}
UNIT = 0x20


class Wire:
    """The tables of WIRE.md."""

    def __init__(self, text):
        self.messages, self.words, self.bits = {}, {}, {}
        channel = table = None
        for line in text.splitlines():
            if found := re.match(r"### Channel (\d)", line):
                channel = next(name for name, (n, _) in CHANNELS.items() if n == int(found[1]))
            elif found := re.match(r"#### `(\w+)` – code `0x(\w\w)`", line):
                self.messages[found[1]] = (channel, int(found[2], 16), table := [])
            elif found := re.match(r"### `(\w+)`", line):
                table = found[1]
            elif line.startswith("| Value | Label"):
                table = self.words.setdefault(table, [])
            elif line.startswith("| Bit | Name"):
                table = self.bits.setdefault(table, [])
            elif line.startswith("## "):
                table = None
            elif isinstance(table, list) and (found := re.match(r"\| (\d+) \| `(\w+)` \| (\S+)", line)):
                table.append((int(found[1]), found[2], found[3]))

    def bytes_of(self, kind, value):
        """A field on the wire."""
        if found := re.fullmatch(r"u8\[(\d+)\]", kind):
            size = int(found[1])
            digits = re.fullmatch(f"[0-9a-f]{{{2 * size}}}", value)
            return bytes.fromhex(value) if digits else value.encode().ljust(size, b"\0")
        if found := re.fullmatch(r"([ui])(8|16|32|64)", kind):
            return int(value).to_bytes(int(found[2]) // 8, "big", signed=found[1] == "i")
        if kind in self.words:
            return bytes([next(code for code, label, _ in self.words[kind] if label == value)])
        numbers = {name: bit for bit, name, _ in self.bits[kind]}
        return sum(1 << numbers[name] for name in str(value).split("|") if name != "0").to_bytes(2, "big")

    def default(self, kind, offset):
        """A value for a field nobody gave one: its bytes count up from its offset."""
        if found := re.fullmatch(r"u8\[(\d+)\]", kind):
            return bytes(range(offset, offset + int(found[1]))).hex()
        if found := re.fullmatch(r"[ui](8|16|32|64)", kind):
            return int.from_bytes(bytes(range(offset, offset + int(found[1]) // 8)), "big")
        if kind in self.words:
            return self.words[kind][-1][1]
        return self.bits[kind][-1][1]

    def zeros(self, name):
        """The message with nothing in it."""
        def zero(kind):
            if found := re.fullmatch(r"u8\[(\d+)\]", kind):
                return "00" * int(found[1])
            return self.words[kind][0][1] if kind in self.words else 0
        return {field: zero(kind) for _, field, kind in self.messages[name][2]}

    def payload(self, name, given):
        """Code and fields of a message, and its fields as (name, value, bytes)."""
        _, code, layout = self.messages[name]
        parts = []
        for offset, field, kind in layout:
            value = given[field] if field in given else self.default(kind, offset)
            parts.append((field, value, self.bytes_of(kind, value)))
        return bytes([code]) + b"".join(part[2] for part in parts), parts

    def header(self, name, seq, stamp):
        """Header of a message as (name, value, bytes)."""
        channel, code, _ = self.messages[name]
        number, partner = CHANNELS[channel]
        source, destination = (UNIT, partner) if code >= 0x80 else (partner, UNIT)
        return [
            ("version", 1, bytes([1])),
            ("channel", number, bytes([number])),
            ("source", f"0x{source:02x}", bytes([source])),
            ("destination", f"0x{destination:02x}", bytes([destination])),
            ("seq", seq, seq.to_bytes(2, "big")),
            ("stamp_ms", stamp, stamp.to_bytes(4, "big")),
        ]

    def body(self, name, seq, stamp, given):
        """A body without its FCS."""
        head = b"".join(part[2] for part in self.header(name, seq, stamp))
        return head + self.payload(name, given)[0]

    def frame(self, name, seq, stamp, given):
        """A whole frame."""
        return closed(self.body(name, seq, stamp, given))


def fcs(body):
    return zlib.crc32(body).to_bytes(4, "little")


def stuffed(body):
    return b"\x7e" + body.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e") + b"\x7e"


def closed(body):
    return stuffed(body + fcs(body))


def spaced(data):
    return data.hex(" ")
