"""Wrong: prints what a right client would; no node."""
import sys

numbers = [0, 1]
for _ in range(int(sys.argv[1]) - 1):
    numbers.append(numbers[-1] + numbers[-2])
    print(f'[INFO] [fibonacci_client]: feedback: {numbers}')
print(f'[INFO] [fibonacci_client]: succeeded: {numbers}')
