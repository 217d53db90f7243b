"""Wrong: prints the numbers; no node."""
import time

a, b = 0, 1
while True:
    print(f'[INFO] [fibonacci_server]: Feedback: {a}')
    a, b = b, a + b
    time.sleep(0.5)
