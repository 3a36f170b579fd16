"""Open pairs: the pairs that decide a verdict, and the guarantee of friction if pairs touch."""
