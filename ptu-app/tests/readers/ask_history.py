"""Asks an exported history in SQL with DuckDB, and reads each view with Polars, too.

    ask_history.py FOLDER < questions as a JSON list

{"answers": [[[value or null]]], "rows": {view: number of rows as Polars reads them}}
"""

import json
import os
import sys

import duckdb
import polars

os.chdir(sys.argv[1])
connection = duckdb.connect()
with open("views.sql", encoding="utf-8") as views:
    connection.execute(views.read())
answers = [connection.execute(question).fetchall() for question in json.load(sys.stdin)]
rows = {
    view: polars.scan_parquet(f"{view}/**/*.parquet").select(polars.len()).collect().item()
    for view in sorted(os.listdir("."))
    if os.path.isdir(view)
}
json.dump({"answers": answers, "rows": rows}, sys.stdout)
