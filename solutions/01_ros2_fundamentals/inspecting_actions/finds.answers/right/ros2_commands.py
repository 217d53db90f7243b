# Right: lets `ros2 action info -t` look, and reads what it prints.
import re
import subprocess
import sys

done = subprocess.run(['ros2', 'action', 'info', '-t', sys.argv[1]], capture_output=True, text=True)
servers = done.stdout.partition('Action servers:')[2]
node, kind = re.search(r'/(\w+) \[(\S+)\]', servers).groups()
print({'node': node, 'type': kind})
