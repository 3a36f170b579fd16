"""STEP files: their products, solids, faces, densities and statements."""
