"""The one error that people see."""


class CutisError(ValueError):
    """Its message is one line for the user: what is wrong and what to do next."""
