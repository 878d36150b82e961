/* Renders the samples of a content folder into its store (pipeline/samples/sample_store.h). It
 * places the sampling points, skips those inside solid matter or below the ground, and shares the
 * rest among processes. docs/samples.md. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLER_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLER_H

#include "base/processes.h"
#include "pipeline/content/scans.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/samples/sample_store.h"

struct sampler_options {
	/* Of the same scans, borrowed: what is far from a point is drawn from coarser patches.
	 * NULL: the whole mesh is drawn, as scans with pictures need. */
	const struct master *master;
	uint32_t jobs;      /* processes; 0: one per core */
	struct shard shard; /* only points with number % count == number of the shard */
	bool below_ground;  /* place points also below the lowest point of the model */
};

/* Places the sampling points of a model: over a box 1.5 times as large, `points` along the longest
 * side and as many on the other sides as keep the spacing similar, but not along the plane of a
 * flat model; above the ground unless below_ground. face_px is the resolution of a face's finest
 * level, which is rounded down to SAMPLE_TILE_PX << n. */
void sampler_grid(struct sample_grid *out, const float low_m[3], const float high_m[3],
		  uint32_t points, uint32_t face_px, bool below_ground);
/* Adds a vantage point where every visit begins: as temple.ini says, or by the model's box. */
void sampler_add_first_view(struct sample_grid *grid, const struct content *content,
			    const float low_m[3], const float high_m[3]);
/* Returns how many levels a face of that resolution has; see sampler_grid. */
uint32_t sampler_levels(uint32_t face_px);
/* Sets out to the position of a point, metres. */
void sampler_point(float out[3], const struct sample_grid *grid, const uint32_t point[3]);

/* Renders all points that are missing, and shows progress. An interrupted run continues where it
 * stopped. The result depends only on the folder. The mesh is read only if a point is missing, and
 * stays with scans. Errors are described in diagnostics. */
must_check int sampler_run(struct scans *scans, const struct sampler_options *options,
			   struct diagnostics *diagnostics);

/* Returns whether the samples that there are were made of these scans with these settings, whether
 * for a budget or not, below the ground or not. Some may be missing. master: of the same scans.
 * Reads no scan. */
bool sampler_is_current(struct scans *scans, const struct master *master);

/* What a run of the sampler would find. */
struct sampler_progress {
	struct sample_grid grid;
	uint32_t point_count, done_count;
	uint64_t done_bytes; /* of the files of the points that are done */
	/* The median time between two points of the runs before; 0: unknown. */
	double seconds_a_point;
};

/* Fills in *out without drawing anything. Returns -ENOENT if the shape of the scans is not known
 * yet, or another error with a diagnostic. */
must_check int sampler_look(struct sampler_progress *out, struct scans *scans,
			    const struct sampler_options *options, struct diagnostics *diagnostics);

#endif
