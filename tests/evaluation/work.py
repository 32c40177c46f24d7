"""Work for the tests of the pool."""


def double(number):
    """Twice a number."""
    return 2 * number
