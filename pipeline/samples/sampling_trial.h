/* A short trial of the sampler on this machine: it draws and encodes a few faces of a made surface
 * and says what each part costs. Used to predict what a build will cost. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLING_TRIAL_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLING_TRIAL_H

#include "pipeline/content/content.h"
#include "pipeline/import/mesh.h"

/* Seconds of one processor. */
struct sampling_trial {
	double start_s;         /* of a process, until it has drawn its first face */
	double face_s;          /* of a face of the content's size that shows little */
	double tile_s;          /* of each tile: its pixels, their shading, and the encoding */
	double triangle_s;      /* of each triangle that is drawn */
	double tile_bytes;      /* of the trial's tiles, at the content's quality */
	uint64_t process_bytes; /* resident memory of the process */
};

/* Draws as the content says (light, colours, size of faces, quality), in a process of its own.
 * Takes about a second of processor time. Errors are those of the sampler. */
must_check int sampling_trial(struct sampling_trial *out, const struct content *content, bool lit);

/* Makes a closed, bumpy ball of 4 n^2 triangles, n at least 2, radius about 1 m. Owned by the
 * caller (mesh_finish). -ENOMEM. */
must_check int sampling_trial_mesh(struct mesh *out, uint32_t n);

#endif
