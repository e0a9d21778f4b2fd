"""What a study found, as lines of a CSV file."""

import csv
import io
from collections.abc import Iterable
from dataclasses import fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def to_csv(kind: "type[DataclassInstance]", records: "Iterable[DataclassInstance]") -> str:
    """One line a record, columns as the fields of their kind; empty where there is no number."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    names = [field.name for field in fields(kind)]
    writer.writerow(names)
    for record in records:
        values = (getattr(record, name) for name in names)
        writer.writerow(["" if value is None else value for value in values])
    return out.getvalue()
