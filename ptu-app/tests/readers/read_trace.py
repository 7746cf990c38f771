"""Reads an exported trace with its format's own reader and prints it as JSON.

    read_trace.py FILE.csv|FILE.parquet|FILE.mcap

{"about": …, "times_s": […], "utc_us": […] or null, "units": {…}, "columns": {name: [sample or null]},
 "headings": [the names in the file, in order]}
"""

import csv
import json
import sys


def number(channel, cell):
    """A cell as a number: of an enumeration its word's, or a number that has no word."""
    if cell is None or cell == "":
        return None
    if "enum" in channel["kind"]:
        numbers = {word: float(n) for n, word in channel["kind"]["enum"]["labels"].items()}
        assert cell in numbers or float(cell) not in numbers.values(), cell
        return numbers[cell] if cell in numbers else float(cell)
    return float(cell)


def read_csv(path):
    with open(path + "-metadata.json", encoding="utf-8") as beside:
        description = json.load(beside)
    with open(path, newline="", encoding="utf-8-sig") as table:
        rows = list(csv.reader(table))
    headings = [column["titles"] for column in description["tableSchema"]["columns"]]
    assert rows[0] == headings, (rows[0], headings)
    assert headings == [column["name"] for column in description["tableSchema"]["columns"]]
    assert headings.pop(0) == "time_s"
    about = description["notes"][0]
    times = [float(row[0]) for row in rows[1:]]
    columns = {
        channel["name"]: [number(channel, row[place + 1]) for row in rows[1:]]
        for place, channel in enumerate(about["channels"])
    }
    units = {channel["name"]: channel["unit"] for channel in about["channels"]}
    return about, times, None, units, columns, headings


def read_parquet(path):
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    about = json.loads(table.schema.metadata[b"ptu.trace"])
    columns = table.to_pydict()
    times = columns.pop("time_s")
    columns.pop("time_utc")
    assert str(table.schema.field("time_utc").type) == "timestamp[us, tz=UTC]"
    utc = table.column("time_utc").cast("int64").to_pylist()
    headings = list(columns)
    for channel, heading in zip(about["channels"], headings, strict=True):
        name, kind = channel["name"], channel["kind"]
        type_name = str(table.schema.field(heading).type)
        values = columns.pop(heading)
        if kind == "bit":
            assert type_name == "bool", type_name
        elif "enum" in kind:
            assert type_name == "string", type_name
        else:
            assert type_name == "double", type_name
        columns[name] = [number(channel, value) for value in values]
    units = {channel["name"]: channel["unit"] for channel in about["channels"]}
    return about, times, utc, units, columns, headings


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
        for schema, topic, message in reader.iter_messages():
            assert topic.topic == "trace" and topic.message_encoding == "json"
            assert schema.encoding == "jsonschema"
            fields = json.loads(schema.data)["properties"]
            sample = json.loads(message.data)
            headings = list(sample)
            for channel, heading in zip(about["channels"], headings, strict=True):
                units[channel["name"]] = fields[heading].get("unit", "")
                columns[channel["name"]].append(number(channel, sample[heading]))
            assert message.log_time % 1000 == 0
            utc.append(message.log_time // 1000)
    trigger = about["t0_us"] + (about["trigger_row"] or 0) * about["period_us"]
    times = [(at - trigger) / 1e6 for at in utc]
    return about, times, utc, units, columns, headings


def main():
    path = sys.argv[1]
    readers = {"csv": read_csv, "parquet": read_parquet, "mcap": read_mcap}
    about, times, utc, units, columns, headings = readers[path.rsplit(".", 1)[1]](path)
    json.dump(
        {
            "about": about,
            "times_s": times,
            "utc_us": utc,
            "units": units,
            "columns": columns,
            "headings": headings,
        },
        sys.stdout,
    )


main()
