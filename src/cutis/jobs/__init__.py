"""Work: one value per job, sets of captures, and where they run."""
