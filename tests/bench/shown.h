/* Counts how much of a settled picture each tile makes up, as the scene blends them. */
#ifndef GOPURA_TESTS_BENCH_SHOWN_H
#define GOPURA_TESTS_BENCH_SHOWN_H

#include <stdio.h>

#include "render/scene/scene.h"

/* Writes a line for each tile in the picture that the scene drew last: its face (face_key), level,
 * row and column, and how many pixels of the visibility pass are its share. Returns -ENOMEM. */
must_check int shown_write(const struct scene *scene, FILE *file);

#endif
