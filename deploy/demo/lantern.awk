# A paper lantern around the origin, for `lpvctl light add`: 24 cm across, a little flat.

BEGIN { sphere("", 0, 0, 0, 0.12, 0.10, 0.12, 14) }
