"""The cases of CIE 171:2006 that apply, and those that do not.

Values are derived here; where a source's or a sky's radiance is free it is chosen so that irradiance has the numbers that
published validations print.
"""

import direct
import openings
import reflection

SKIPPED = (
    ("4.1 to 4.6", "The experimental cases compare with measurements of rooms and luminaires that are not free."),
    ("5.2, 5.3 asymmetrical", "Lights are Lambertian: there are no tables of intensity by direction."),
    ("5.5, 5.10, 5.12", "Panes let a share through that does not depend on the angle, so glass by direction has no counterpart."),
    ("5.9 to 5.14, CIE skies but the uniform one", "There is no sky whose radiance depends on direction; a uniform one is a luminous opening or plane."),
    ("5.11 to 5.14, externally reflected component", "Ground and masks are black here, so that what is left is a closed form."),
    ("6", "The additional cases ask for specular, glossy or spectral surfaces; every surface is Lambertian in three colours."),
)


def all_scenes():
    for family in (direct.point_sources, direct.area_sources, direct.flux, reflection.one_surface, reflection.obstruction,
                   reflection.closed_cube, openings.luminous, openings.skies):
        yield from family()
