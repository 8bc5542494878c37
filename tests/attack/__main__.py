"""What shut others out, or ended the server, tried on the built program: `python3 tests/attack [NAME ...]`.

Each attack starts a server of its own on 127.0.0.1 and answers rows of (what, figure, bound, unit); a figure past its bound
fails. `ARCSLIP` names the program; the default is the release build of this repository.
"""

import importlib
import sys
import time

ATTACKS = ["expander", "searches", "lists", "slow_bodies", "long_checks"]


def main(names):
    unknown = [name for name in names if name not in ATTACKS]
    if unknown:
        sys.exit(f"there is no attack {', '.join(unknown)}; there are {', '.join(ATTACKS)}")
    failed = 0
    for name in names or ATTACKS:
        began = time.monotonic()
        print(f"{name}:", flush=True)
        for what, figure, bound, unit in importlib.import_module(name).run():
            holds = figure <= bound
            failed += not holds
            print(f"  {'' if holds else 'FAILS '}{what}: {figure:.3g} {unit} (at most {bound:g})", flush=True)
        print(f"  ({time.monotonic() - began:.1f} s)", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
