"""Tables of the documentation that tools rewrite in place."""

from pathlib import Path

from studies.generated import record

DOCS = Path(__file__).parents[1] / "docs"


def rewrite(page: str, **tables: str) -> None:
    """Puts each table between `<!-- name -->` and `<!-- /name -->` of docs/`page`."""
    path = DOCS / page
    text = path.read_text("utf-8")
    for name, table in tables.items():
        start, end = f"<!-- {name} -->", f"<!-- /{name} -->"
        before, rest = text.split(start)
        text = f"{before}{start}\n\n{table}\n\n{end}" + rest.split(end)[1]
    path.write_text(text, encoding="utf-8")
    record(*(f"docs/{page}#{name}" for name in tables))
    print(f"wrote docs/{page}")
