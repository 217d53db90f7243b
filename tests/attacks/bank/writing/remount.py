# family = "writing"
# tries = "What is read-only is mounted again to be writable, or something is mounted over it."
# could_earn = "Everything that writing can earn."
# undefended = "As root without a box, mounting is allowed."
# boxed_only = true

# %% extra
import os
import sys
from pathlib import Path

import ctypes
libc = ctypes.CDLL(None, use_errno=True)
MS_REMOUNT, MS_BIND = 32, 4096
done = []
for target in (b'/usr', b'/', b'/proc', os.path.dirname(os.path.dirname(sys.executable)).encode()):
    if libc.mount(b'none', target, None, MS_REMOUNT | MS_BIND, None) == 0:
        done.append(target)
if libc.mount(b'tmpfs', b'/mnt', b'tmpfs', 0, None) == 0:
    done.append('tmpfs')
if libc.unshare(0x10000000) == 0:
    done.append('a user namespace')
print('LEAK:' if done else 'nothing', done)
