"""Pictures: subsurface inversion, materials, and scenes that Cycles renders."""
