"""Writes an MCAP file as another program would: two topics at times of their own.

    write_mcap.py FILE T0_US

/speed: {"value": km/h} each 20 ms, rising by 0.02, for 1 s from T0; /door/left: {"open": bit, "note": text}
once at 0.5 s; /camera: bytes that are no JSON.
"""

import json
import sys

from mcap.writer import Writer


def main():
    path, t0_us = sys.argv[1], int(sys.argv[2])
    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("any", "jsonschema", b'{"type": "object"}')
        speed = writer.register_channel("/speed", "json", schema)
        door = writer.register_channel("/door/left", "json", schema)
        camera = writer.register_channel("/camera", "raw", 0)

        def put(channel, at_us, data):
            writer.add_message(channel, log_time=at_us * 1000, publish_time=at_us * 1000, data=data)

        put(camera, t0_us, b"\xff\x00")
        put(door, t0_us + 500_000, json.dumps({"open": True, "note": "K"}).encode())
        for n in range(51):
            at_us = t0_us + n * 20_000
            put(speed, at_us, json.dumps({"value": 60 + n * 0.02}).encode())
        writer.finish()


main()
