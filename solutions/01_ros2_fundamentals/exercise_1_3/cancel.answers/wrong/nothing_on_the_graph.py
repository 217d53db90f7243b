"""Wrong: no ROS, just the lines that a right client would print."""
import time


class CancelingClient:
    def __init__(self):
        self.count = 0

    def send_goal(self):
        print('Sending goal request... order=20')

    def on_response(self, future):
        print('Goal accepted')

    def on_feedback(self, message):
        self.count += 1
        print('Feedback', self.count)

    def on_result(self, future):
        print('Goal was canceled')


def main():
    client = CancelingClient()
    client.send_goal()
    client.on_response(None)
    for _ in range(3):
        client.on_feedback(None)
        time.sleep(0.5)
    client.on_result(None)


if __name__ == '__main__':
    main()
