"""Reads an exported trace with its format's own reader and prints it as JSON.

    read_trace.py FILE.csv|FILE.parquet|FILE.mcap

{"about": …, "times_s": […], "utc_us": […] or null, "units": {…}, "columns": {name: [sample or null]}}
"""

import csv
import json
import sys


def read_csv(path):
    with open(path + "-metadata.json", encoding="utf-8") as beside:
        description = json.load(beside)
    with open(path, newline="", encoding="utf-8") as table:
        rows = list(csv.reader(table))
    headings = [column["titles"] for column in description["tableSchema"]["columns"]]
    assert rows[0] == headings, (rows[0], headings)
    names = [column["name"] for column in description["tableSchema"]["columns"]]
    number = lambda cell: float(cell) if cell else None
    columns = {
        name: [number(row[place]) for row in rows[1:]]
        for place, name in enumerate(names)
    }
    times = columns.pop("time_s")
    about = description["notes"][0]
    units = {channel["name"]: channel["unit"] for channel in about["channels"]}
    return about, times, None, units, columns


def read_parquet(path):
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    about = json.loads(table.schema.metadata[b"ptu.trace"])
    columns = table.to_pydict()
    times = columns.pop("time_s")
    columns.pop("time_utc")
    assert str(table.schema.field("time_utc").type) == "timestamp[us, tz=UTC]"
    utc = table.column("time_utc").cast("int64").to_pylist()
    for channel in about["channels"]:
        name, kind = channel["name"], channel["kind"]
        type_name = str(table.schema.field(name).type)
        if kind == "bit":
            assert type_name == "bool", type_name
            columns[name] = [None if v is None else float(v) for v in columns[name]]
        elif "enum" in kind:
            # Words, or a number that has none.
            assert type_name == "string", type_name
            numbers = {word: float(n) for n, word in kind["enum"]["labels"].items()}
            value = lambda word: numbers[word] if word in numbers else float(word)
            columns[name] = [None if v is None else value(v) for v in columns[name]]
        else:
            assert type_name == "double", type_name
    units = {channel["name"]: channel["unit"] for channel in about["channels"]}
    return about, times, utc, units, columns


def read_mcap(path):
    from mcap.reader import make_reader

    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        about = json.loads(metadata["ptu.trace"]["about"])
        names = [channel["name"] for channel in about["channels"]]
        columns = {name: [] for name in names}
        utc = []
        units = {}
        for schema, channel, message in reader.iter_messages():
            assert channel.topic == "trace" and channel.message_encoding == "json"
            assert schema.encoding == "jsonschema"
            fields = json.loads(schema.data)["properties"]
            units = {name: fields[name].get("unit", "") for name in names}
            sample = json.loads(message.data)
            for name in names:
                value = sample[name]
                columns[name].append(None if value is None else float(value))
            assert message.log_time % 1000 == 0
            utc.append(message.log_time // 1000)
    trigger = about["t0_us"] + (about["trigger_row"] or 0) * about["period_us"]
    times = [(at - trigger) / 1e6 for at in utc]
    return about, times, utc, units, columns


def main():
    path = sys.argv[1]
    readers = {"csv": read_csv, "parquet": read_parquet, "mcap": read_mcap}
    about, times, utc, units, columns = readers[path.rsplit(".", 1)[1]](path)
    json.dump(
        {"about": about, "times_s": times, "utc_us": utc, "units": units, "columns": columns},
        sys.stdout,
    )


main()
