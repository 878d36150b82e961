/* One step of a deformation as a lattice: its moves are done on lattices that get finer level by
 * level, whatever their order in the file, so coarse and fine ones can be changed in turn. */
#ifndef GOPURA_PIPELINE_DEFORM_LATTICE_STEP_H
#define GOPURA_PIPELINE_DEFORM_LATTICE_STEP_H

#include <stddef.h>

#include "pipeline/deform/control_lattice.h"
#include "pipeline/deform/deform_plan.h"
#include "pipeline/deform/warp.h"

/* Makes the lattice of a step in the box low..high, ready for lattice_warp. *out is owned by the
 * caller; it is zeroed on failure. -ENOMEM. */
must_check int lattice_step_make(struct control_lattice *out, const struct deform_step *step,
				 const double low[3], const double high[3]);

struct lattice_blame {
	unsigned line; /* of the move in the file; 0: no move reaches the place */
	uint32_t level;
	int point[3];
};

/* Finds the point whose move changes a place most. low and high as above. -ENOMEM. */
must_check int lattice_step_blame(struct lattice_blame *out, const struct deform_step *step,
				  const double low[3], const double high[3], const double place[3]);

/* lattice is borrowed. */
struct warp lattice_warp(const struct control_lattice *lattice);

#endif
