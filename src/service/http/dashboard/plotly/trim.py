#!/usr/bin/env python3
"""Makes plotly.js.gz of Plotly's plotly.min.js: python3 trim.py plotly.min.js

It leaves out the wrapper for other module loaders, because of which a browser parses the script three times, and the trace
types that the dashboard does not draw. Scatter plots are part of the core.
"""

import gzip
import pathlib
import sys

LICENCE_END = "*/"
BEGIN = '"use strict";var Plotly='
END = "\nreturn Plotly;\n}));"
REGISTERED = ".register(["

script = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
licence = script[: script.index(LICENCE_END)]
own = script[script.index(BEGIN) : script.index(END)]
before, _, traces = own.partition(REGISTERED)
after = traces.partition("])")[2]
trimmed = "".join([licence, LICENCE_END, "\n", before, REGISTERED, "])", after])
target = pathlib.Path(__file__).with_name("plotly.js.gz")
target.write_bytes(gzip.compress(trimmed.encode(), 9, mtime=0))
