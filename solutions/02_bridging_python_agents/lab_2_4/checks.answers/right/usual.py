# Right: what the notebook asks for, as a program.
import ast
import json
import math
import sys
from typing import Any

from jsonschema import Draft202012Validator

TOOLS: dict[str, dict[str, Any]] = {
    "lamp": {"on": {"type": "boolean"}},
    "walk_to": {
        "x": {"type": "number", "minimum": 0, "maximum": 6},
        "y": {"type": "number", "minimum": 0, "maximum": 4},
    },
    "say": {"text": {"type": "string", "minLength": 1, "maxLength": 60}},
}


def fits(value: Any, schema: dict[str, Any]) -> bool:
    """Return True if a schema allows a value."""
    return Draft202012Validator(schema).is_valid(value)


def find_fault(text: str) -> Any:
    """Return what is wrong with a call, beginning with the name of the field; an empty text if nothing is."""
    try:
        call = json.loads(text)
    except ValueError:
        call = None
    if not isinstance(call, dict):
        return "json has to be an object"
    if call.get("tool") not in list(TOOLS):
        return f"tool has to be one of {list(TOOLS)}"
    for name, schema in TOOLS[call["tool"]].items():
        if not fits(value := call.get(name), schema) or (isinstance(value, float) and not math.isfinite(value)):
            return f"{name} is {value}, and has to fit {schema}"
    return ""


def first_words(calls: list[str]) -> list[Any]:
    """Return the first word about each call."""
    faults = [find_fault(call) for call in calls]
    # A fault is None as long as find_fault is not written.
    return [fault and fault.split()[0].strip(":,.'\"`") for fault in faults]


print(first_words(ast.literal_eval(sys.argv[1])))
