"""cutis: from an RGB albedo of skin to maps of what it is made of, and back."""

__version__ = "0.1.0"
