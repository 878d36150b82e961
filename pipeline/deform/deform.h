/* Deforms a mesh step by step (paper 003, appendix C): straightens a leaning pillar, or takes the
 * warp out of a capture. Triangles are divided only where they bend; a step that would fold the
 * mesh over is refused. */
#ifndef GOPURA_PIPELINE_DEFORM_DEFORM_H
#define GOPURA_PIPELINE_DEFORM_DEFORM_H

#include "base/diagnostics.h"
#include "pipeline/deform/deform_plan.h"
#include "pipeline/deform/mesh_measure.h"
#include "pipeline/import/mesh.h"

struct deform_report {
	struct mesh_measure before, after;
	/* of the lines through the middle of the box along x, y and z */
	double length_before[3], length_after[3];
	double tolerance; /* that was kept */
	/* how much the volume around a vertex grew: the least and the most of all steps */
	double least_growth, most_growth;
};

/* Deforms the mesh. path: the file of the plan, for messages; jobs: number of threads; the result
 * does not depend on it. A negative errno; diagnostics names the file, the step and the cure, and
 * the mesh is only to be finished. -EDOM: it would fold over, or the tolerance is too small. */
must_check int deform(struct mesh *mesh, const struct deform_plan *plan, const char *path,
		      uint32_t jobs, struct deform_report *report, struct diagnostics *diagnostics);

#endif
