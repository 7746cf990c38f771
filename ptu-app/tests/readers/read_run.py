"""Reads a whole run's MCAP with the format's own reader: topics, counts, order of times, and the events.

read_run.py FILE: one line of JSON.
"""
import json
import sys

from mcap.reader import make_reader

counts, last, ordered, events = {}, 0, True, []
speeds = []
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        counts[channel.topic] = counts.get(channel.topic, 0) + 1
        ordered &= message.log_time >= last
        last = message.log_time
        said = json.loads(message.data)
        if channel.topic == "events":
            events.append(message.data.decode())
        else:
            speeds.append(said["train_speed_kmh"])
            # Every field is one that the schema explains.
            assert said.keys() == json.loads(schema.data)["properties"].keys()
print(json.dumps({
    "counts": counts, "ordered": ordered, "events": events,
    "fastest_kmh": max(speed for speed in speeds if speed is not None),
}))
