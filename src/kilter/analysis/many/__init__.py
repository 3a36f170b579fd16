"""Many assemblies at once: verdicts, and files of them."""
