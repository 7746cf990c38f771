"""Instruments that pyvisa-sim plays, each at a TCP port that sinstruments serves: `instruments.py FILE NAME=PORT ...`."""
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
Server(
    devices=[
        {"class": "Instrument", "package": "__main__", "name": name, "transports": [{"type": "tcp", "url": ["127.0.0.1", int(port)]}]}
        for name, port in places
    ]
).serve_forever()
