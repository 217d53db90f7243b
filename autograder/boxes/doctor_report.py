"""``python -m autograder.boxes.doctor_report``: whether boxes are possible here, as one line of JSON for the doctor."""

from __future__ import annotations

import json

from autograder.boxes.guards import guards
from autograder.boxes.sandbox import why_impossible

if __name__ == "__main__":
    print(json.dumps({"why_impossible": why_impossible(), "guards": dict(guards())}))
