"""Pictures of skin by path tracing."""
