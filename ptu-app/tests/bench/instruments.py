"""Instruments that pyvisa-sim plays, each at a TCP port, served by sinstruments, or at a serial line of
its own: `instruments.py FILE NAME=PORT|LINK ...`."""
import sys

from pyvisa_sim.parser import get_devices
from sinstruments.simulator import BaseDevice, Server


class Instrument(BaseDevice):
    """Hands each line to the instrument of pyvisa-sim, and its answer back."""

    def __init__(self, name, **options):
        super().__init__(name, **options)
        self.device = DEVICES["TCPIP0::%s::5025::SOCKET" % name]

    def handle_message(self, line):
        self.device.write(line.rstrip(b"\r\n") + b"\n")
        answer = b""
        while True:
            byte, _ = self.device.read()
            if not byte:
                return answer or None
            answer += byte


FILE, *PLACES = sys.argv[1:]
DEVICES = get_devices(FILE, False)
places = [place.split("=") for place in PLACES]


def transport(place):
    if place.isdigit():
        return {"type": "tcp", "url": ["127.0.0.1", int(place)]}
    return {"type": "serial", "url": place}


Server(
    devices=[
        {"class": "Instrument", "package": "__main__", "name": name, "transports": [transport(one) for named, one in places if named == name]}
        for name in dict(places)
    ]
).serve_forever()
