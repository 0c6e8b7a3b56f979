"""The tables of a run in pandas, Polars and DuckDB.

    check.py

Runs a shipped scenario, opens trajectory.parquet with each of the three and
trajectory.csv beside it, and compares: the names and the types of all columns,
every number bit for bit, and what summary.json and the file's metadata say of
them. Prints one line of figures.
"""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import duckdb
import numpy
import pandas
import polars
import pyarrow.parquet

HERE = Path(__file__).resolve().parent
BINARY = Path(os.environ.get("FORWARDSTEP", HERE.parent.parent / "target" / "release" / "forwardstep")).resolve()
SCENARIO = os.environ.get("SCENARIO", "first-order")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        ran = subprocess.run([BINARY, "run", SCENARIO, "--out", folder, "--csv"], capture_output=True, text=True)
        assert ran.returncode == 0, ran.stderr
        file = folder / "trajectory.parquet"
        summary = json.loads((folder / "summary.json").read_text())

        frame = pandas.read_parquet(file)
        rows, columns = frame.shape
        names = list(frame.columns)
        assert all(kind == numpy.float64 for kind in frame.dtypes)
        # As bits: NaN is where nothing was computed.
        bits = frame.to_numpy().tobytes()

        lazy = polars.scan_parquet(file).collect()
        assert lazy.columns == names and set(lazy.dtypes) == {polars.Float64}
        assert numpy.ascontiguousarray(lazy.to_numpy()).tobytes() == bits

        table = duckdb.sql(f"SELECT * FROM read_parquet('{file}')")
        assert table.columns == names and set(map(str, table.types)) == {"DOUBLE"}
        fetched = table.fetchnumpy()
        assert numpy.column_stack([fetched[name] for name in names]).tobytes() == bits
        last = duckdb.sql(f"SELECT max(t_s) FROM read_parquet('{file}')").fetchall()[0][0]
        assert last == summary["ending"]["t_s"], (last, summary["ending"])

        written = pandas.read_csv(folder / "trajectory.csv")
        assert list(written.columns) == names and written.to_numpy(dtype=float).tobytes() == bits

        said = pyarrow.parquet.read_schema(file).metadata
        units = json.loads(said[b"forwardstep.units"])
        assert list(units) == names or sorted(units) == sorted(names)
        assert said[b"forwardstep.scenario_digest_blake3"].decode() == summary["scenario"]["digest_blake3"]
        for agent in summary["agents"]:
            own = [name for name in names if name.startswith(agent["name"] + ".")]
            assert own and all(any(f".{axis}" in name for name in own) for axis in agent["axes"]), agent
        print(
            f"{SCENARIO}: {rows} rows, {columns} columns, the same bits in pandas {pandas.__version__}, Polars {polars.__version__},"
            f" DuckDB {duckdb.__version__} and the CSV; units of all columns in the metadata"
        )


if __name__ == "__main__":
    main()
