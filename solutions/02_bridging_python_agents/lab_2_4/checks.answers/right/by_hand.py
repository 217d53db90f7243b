# Right: no schema, but a match statement, and comparisons that are false for nan.
import ast
import json
import sys


def is_number(value, top):
    return type(value) in (int, float) and 0 <= value <= top


def find_fault(text):
    try:
        call = json.loads(text)
    except json.JSONDecodeError:
        return "json"
    match call:
        case {"tool": "lamp", **fields}:
            return "" if type(fields.get("on")) is bool else "on: true or false"
        case {"tool": "walk_to", **fields}:
            if not is_number(fields.get("x"), 6):
                return "x: a number from 0 to 6"
            return "" if is_number(fields.get("y"), 4) else "y: a number from 0 to 4"
        case {"tool": "say", **fields}:
            words = fields.get("text")
            return "" if isinstance(words, str) and 1 <= len(words) <= 60 else "text: 1 to 60 letters"
        case dict():
            return "tool: lamp, walk_to or say"
    return "json: an object"


def first_words(calls):
    return [fault and fault.split()[0].strip(":,.'\"`") for fault in map(find_fault, calls)]


print(first_words(ast.literal_eval(sys.argv[1])))
