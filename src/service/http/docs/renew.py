#!/usr/bin/env python3
"""Renews Swagger UI: python3 renew.py FOLDER, the unpacked npm package `swagger-ui-dist`."""

import gzip
import pathlib
import shutil
import sys

package, here = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).parent
for name in ("swagger-ui-bundle.js", "swagger-ui.css"):
    # Without the reference to a map of sources, which is not served.
    text = "".join(line for line in (package / name).read_text().splitlines(True) if "sourceMappingURL" not in line)
    (here / f"{name}.gz").write_bytes(gzip.compress(text.encode(), 9, mtime=0))
for name in ("LICENSE", "NOTICE"):
    shutil.copyfile(package / name, here / name)
(here / "LICENSES-OF-PARTS").write_text((package / "swagger-ui-bundle.js.LICENSE.txt").read_text())
