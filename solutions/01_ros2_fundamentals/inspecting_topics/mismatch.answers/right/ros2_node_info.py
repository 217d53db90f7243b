# Right: lets `ros2 node info` look, and reads what it prints.
import re
import subprocess
import sys


def section(text, title):
    """The topics below one title, without those of every node."""
    lines = text.split(title + ':')[1].split('\n    ')[1:]
    pairs = [line.split(': ') for line in re.split('\n  \\w', '\n'.join(lines))[0].splitlines()]
    return [(name.strip(), kind.strip()) for name, kind in pairs if name.strip() not in ('/rosout', '/parameter_events')]


def info(node):
    done = subprocess.run(['ros2', 'node', 'info', node], capture_output=True, text=True)
    return done.stdout


if __name__ == '__main__':
    (published, kind), = section(info(sys.argv[1]), 'Publishers')
    (subscribed, other), = section(info(sys.argv[2]), 'Subscribers')
    print({'topic_published': published, 'type_published': kind,
           'topic_subscribed': subscribed, 'type_subscribed': other})
