"""Run the bank of attacks by hand: all of it several times in a row, or single attacks without their defence.

python tests/attacks/run.py --repeat 3
python tests/attacks/run.py --repeat 3 --as-user
python tests/attacks/run.py gradebook neighbours --unsafe-no-sandbox
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from attack_bank import Attack, attacks
from attack_class import AttackClass, Traps
from attack_demands import general_objections, objections, traces
from ordinary_user import OPEN_FILES

UNSAFE = "--unsafe-no-sandbox"


def main() -> int:
    """Grade, and print what did not hold."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("names", nargs="*", help="only attacks whose name or family is one of these")
    options.add_argument("--repeat", type=int, default=1, help="so many times in a row")
    options.add_argument(
        UNSAFE, action="store_true", help="without boxes; leaves out what would harm this machine"
    )
    options.add_argument(
        "--as-user",
        action="store_true",
        help=f"as root: let a user without any right grade, with a soft limit of {OPEN_FILES:,} open files",
    )
    given = options.parse_args()
    chosen = [
        attack for attack in attacks() if not given.names or {attack.name, attack.family} & set(given.names)
    ]
    extra = [UNSAFE] if given.unsafe_no_sandbox else []
    if given.unsafe_no_sandbox:
        chosen = [attack for attack in chosen if not attack.boxed_only]
    failed = 0
    for number in range(given.repeat):
        failed += _run(chosen, extra, given)
        print(f"run {number + 1} of {given.repeat} is over", flush=True)
    return 1 if failed else 0


def _run(chosen: list[Attack], extra: list[str], given: argparse.Namespace) -> int:
    with tempfile.TemporaryDirectory(prefix="attacks-") as folder, Traps(Path(folder)) as traps:
        made = AttackClass(Path(folder), traps, as_user=given.as_user)
        for attack in chosen:
            made.hand_in(attack)
        graded = made.grade(*extra)
        if graded.exit_code:
            print(graded.output[-4000:])
        failed = 0
        for attack in chosen:
            found = objections(attack, graded, traps)
            failed += bool(found)
            print(
                f"{'LOST' if found else 'held'}  {attack.family}/{attack.name}  {graded.points(attack.name)}"
            )
            for objection in found[:6]:
                print(f"        {objection}")
        found = general_objections(chosen, graded, traps)
        for objection in found[:40]:
            print(f"        the batch: {objection}")
        for name in traces():
            print(f"        removing {name}")
            Path(name).unlink(missing_ok=True)
        print(f"{len(chosen) - failed} of {len(chosen)} attacks defeated in {graded.seconds:.1f} s")
        return failed + len(found)


if __name__ == "__main__":
    sys.exit(main())
