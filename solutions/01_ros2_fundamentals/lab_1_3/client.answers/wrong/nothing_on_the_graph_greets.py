"""Wrong: main() says something, and does nothing."""


def main():
    """Ask the server."""
    print('The client has started.')


if __name__ == '__main__':
    main()
