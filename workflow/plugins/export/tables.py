"""Tables of a run or a sweep: CSV with units in its headings, and Parquet with the columns of that CSV."""

import io
from pathlib import Path

from granchain.parts import quantity
from workflow.plugins.export.figure_numbers import caption, columns_of
from workflow.plugins.export.request import Writers
from workflow.plugins.export.results import Results

CAPTIONS = "figures.csv"
"""Name of the table of what each file of a figure shows."""


def csv(results: Results) -> Writers:
    """Every table and, of a run, the numbers behind every figure, a file for each panel."""
    return {**_of_texts(results.tables), **numbers(results)}


def numbers(results: Results) -> Writers:
    """Numbers behind every figure of a run, a file of CSV for each panel, and a table of their captions."""
    texts, rows = {}, []
    for name, sheet in results.figures.items():
        tables = ((columns_of(panel), panel, title) for panel, title in zip(sheet.panels, sheet.titles, strict=True))
        for place, (columns, panel, title) in enumerate((table for table in tables if table[0]), 1):
            file = f"figure-{name}-{place}.csv"
            texts[file] = quantity.to_csv(columns)
            rows.append((file, caption(panel, title, sheet.title)))
    if rows:
        files, sentences = zip(*rows, strict=True)
        texts[CAPTIONS] = quantity.to_csv({"file": list(files), "caption": list(sentences)})
    return _of_texts(texts)


def _of_texts(texts: dict[str, str]) -> Writers:
    """Writers of files with these texts."""
    return {
        name: lambda path, text=text: path.write_text(text, encoding="utf-8")  # type: ignore[misc]
        for name, text in texts.items()
    }


def parquet(results: Results) -> Writers:
    """Every table; an undefined number is null, and a column without any number one of float64."""
    return {
        f"{Path(name).stem}.parquet": lambda path, text=text: _write_parquet(text, path)  # type: ignore[misc]
        for name, text in results.tables.items()
    }


def _write_parquet(text: str, path: Path) -> None:
    import pyarrow
    import pyarrow.csv
    import pyarrow.parquet

    table = pyarrow.csv.read_csv(
        io.BytesIO(text.encode()), parse_options=pyarrow.csv.ParseOptions(newlines_in_values=True)
    )
    types = [pyarrow.float64() if pyarrow.types.is_null(field.type) else field.type for field in table.schema]
    pyarrow.parquet.write_table(table.cast(pyarrow.schema(list(zip(table.column_names, types, strict=True)))), path)
