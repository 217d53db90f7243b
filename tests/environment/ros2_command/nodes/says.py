"""Print the arguments and end with the exit code that the first one names."""

import sys

print(*sys.argv[1:])
print("on stderr", file=sys.stderr)
sys.exit(int(sys.argv[1]) if len(sys.argv) > 1 and sys.argv[1].isdigit() else 0)
