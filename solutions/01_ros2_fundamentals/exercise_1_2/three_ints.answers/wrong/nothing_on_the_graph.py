"""Wrong: plain arithmetic, no ROS."""
import sys


class ThreeInts:
    def __init__(self):
        self.numbers = [int(word) for word in sys.argv[1:4]]

    def total(self):
        return sum(self.numbers)


def main():
    print('Final sum:', ThreeInts().total())


if __name__ == '__main__':
    main()
