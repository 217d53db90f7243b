"""Grading a class: an nbgrader course directory whose notebooks are judged on the wire."""

import sys

# jsonschema, which nbformat and nbgrader import, loads a grammar of internationalised addresses where it finds one:
# a second at every start, for a check that no notebook asks for. It does without where the import fails.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
