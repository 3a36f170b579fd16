"""Lists of toy bricks: LDraw, StableLego and BrickGPT."""
