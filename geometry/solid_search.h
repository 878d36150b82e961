/* Finds a way from free cell to free cell of the octree of where an eye may be. For
 * geometry/solid_way.c alone, which makes it short and round. */
#ifndef GOPURA_GEOMETRY_SOLID_SEARCH_H
#define GOPURA_GEOMETRY_SOLID_SEARCH_H

#include "format/solid.h"

enum { SOLID_SEARCH_CELLS_MAX = 1 << 18 /* that are looked at before it gives up */ };

/* Sets *points_m, owned by the caller (free), to the centres of *count cells, each beside the one
 * before; the lines between them are free. The first holds the place `from`, the last `to`, both in
 * smallest cells and free. Returns -ENOENT if there is no way or it would take too long, or
 * -ENOMEM. */
must_check int solid_search(const struct solid *solid, const int32_t from[3], const int32_t to[3],
			    float (**points_m)[3], uint32_t *count);

#endif
