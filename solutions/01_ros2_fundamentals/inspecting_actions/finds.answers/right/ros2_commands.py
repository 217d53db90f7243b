# Right: lets `ros2 action info -t` look, and reads what it prints.
import re
import subprocess
import sys

done = subprocess.run(['ros2', 'action', 'info', '-t', sys.argv[1]], capture_output=True, text=True)
servers = done.stdout.partition('Action servers:')[2]
server = re.search(r'/(\w+) \[(\S+)\]', servers)
if server is None:
    raise TimeoutError('no node serves it')
node, kind = server.groups()
print({'node': node, 'type': kind})
