"""One module an engine: each sees the scene and its engine, never another model."""
