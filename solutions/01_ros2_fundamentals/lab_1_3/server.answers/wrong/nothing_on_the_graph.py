"""Wrong: prints what a right server would log; no node."""
import time

print('[INFO] [add_two_ints_server]: Add two ints service ready.')
while True:
    print('[INFO] [add_two_ints_server]: Incoming request: a=5, b=7')
    print('[INFO] [add_two_ints_server]: Sending response: sum=12')
    time.sleep(1)
