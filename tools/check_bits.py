#!/usr/bin/env python3
"""Looks for code whose result may differ between machines: functions of the system's mathematical library, random
distributions and shuffles of the standard library, and reductions in no fixed order. Use src/base/elementary.hpp,
src/base/random.hpp and src/base/keyed_random.hpp instead.

Charts of reports are left out: they are pictures, whose coordinates are rounded to a tenth of a pixel.
"""
import pathlib
import re
import sys

# Square roots, fmod, ldexp, rounding and the like are exact everywhere.
FUNCTIONS = ("a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|tgamma|lgamma|erfc?|fma|reduce|"
             r"transform_reduce|shuffle|sample|\w+_distribution|mt19937(_64)?|default_random_engine|random_device")
FORBIDDEN = re.compile(rf"\bstd::({FUNCTIONS})\b")
COMMENT = re.compile(r"//.*")
PICTURES = pathlib.Path("src/report/chart.cpp")


def main() -> int:
    found = []
    files = [p for root in ("include", "src") for p in sorted(pathlib.Path(root).rglob("*"))
             if p.suffix in {".hpp", ".cpp", ".inl"} and p != PICTURES]
    for path in files:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            for match in FORBIDDEN.finditer(COMMENT.sub("", line)):
                found.append(f"{path}:{number}: {match.group()}: its last bits may depend on the machine")
    print("\n".join(found + [f"{len(files)} files, {len(found)} results that depend on the machine"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
