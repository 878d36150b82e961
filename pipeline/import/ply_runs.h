/* Reads runs of binary elements of one size with several threads. Private to
 * pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_RUNS_H
#define GOPURA_PIPELINE_IMPORT_PLY_RUNS_H

#include "pipeline/import/ply_header.h"

/* Delivers as many of the element's first items as are valid and of one size, because the place in
 * the file of each is then known: vertices without lists, and faces that are triangles. *count is
 * how many; it may be 0. The input then stands behind them, and the rest, with its faults, is left
 * to the caller. Faces must be the first of the file, which begins where the input stands. Returns
 * 0, or what the visitor returned. */
must_check int ply_runs_read(uint64_t *count, struct ply *ply, const struct ply_element *element,
			     const struct ply_visitor *visitor);

#endif
