"""Wrong: main() has nothing but its docstring yet."""


def main():
    """Make the node and spin it."""


if __name__ == '__main__':
    main()
