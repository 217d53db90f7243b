# family = "breaking"
# tries = "Compressed data of a few kilobytes is unpacked to eight gigabytes, in memory and on disk."
# could_earn = "A host without memory or disk."
# boxed_only = true

# %% extra
import lzma
import zlib

small = zlib.compress(b"\0" * 100_000_000, 9)
with open("unpacked", "wb") as file:
    for _ in range(80):
        try:
            file.write(zlib.decompress(small))
        except OSError as error:
            print(error)
            break
big = [zlib.decompress(small) for _ in range(80)]
print("LEAK: eight gigabytes of memory", len(big))
