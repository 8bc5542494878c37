"""Executes the notebooks in `examples`; those of 15 lines have no more, and the manual shows their code.

    python run_notebooks.py [--picture FILE]

`--picture` writes the last picture of `arch.ipynb`.
"""

import argparse
import base64
import pathlib

import nbclient
import nbformat

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "examples"
CHAPTER = HERE.parents[2] / "src/manual/python.md"
MOST_LINES = 15


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--picture", type=pathlib.Path)
    picture = arguments.parse_args().picture
    chapter = CHAPTER.read_text(encoding="utf-8")
    for file in sorted(EXAMPLES.glob("*.ipynb")):
        notebook = nbformat.read(file, as_version=4)
        cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
        lines = [line for cell in cells for line in cell.source.splitlines() if line.strip()]
        if len(lines) > MOST_LINES:
            raise SystemExit(f"{file.name} has {len(lines)} lines, at most {MOST_LINES}")
        for cell in cells:
            if cell.source.strip() not in chapter:
                raise SystemExit(f"{CHAPTER.name} does not show a cell of {file.name}:\n{cell.source}")
        nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
        outputs = [output for cell in cells for output in cell.get("outputs", [])]
        pictures = [output.data["image/png"] for output in outputs if "image/png" in output.get("data", {})]
        if not pictures:
            raise SystemExit(f"{file.name} draws nothing")
        print(f"{file.name}: executed, {len(lines)} lines, {len(pictures)} pictures")
        if picture and file.stem == "arch":
            picture.write_bytes(base64.b64decode(pictures[-1]))


if __name__ == "__main__":
    main()
