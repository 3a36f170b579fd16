"""Motions of parts that cost no energy to first order (neutral motions).

- `null_space`: motions that keep contact rows closed
- `free_motions`, `free_span`: motions that keep every gap and the energy
- `sharp_points`: motions that open edges and corners without a unique normal
- `rolling`: motions without slip, with friction at the contacts
"""
