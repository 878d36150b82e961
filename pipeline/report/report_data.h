/* What the report shows, taken from the files of the stages. */
#ifndef GOPURA_PIPELINE_REPORT_REPORT_DATA_H
#define GOPURA_PIPELINE_REPORT_REPORT_DATA_H

#include "pipeline/hierarchy/master.h"
#include "pipeline/hierarchy/master_cut.h"
#include "pipeline/report/report.h"
#include "pipeline/samples/portrait.h"
#include "pipeline/samples/sample_store.h"

enum {
	REPORT_LEVELS_MAX = 64,
	REPORT_COSTLY_MAX = 10,
	REPORT_THUMBNAILS_MAX = 12,
	REPORT_PICTURE_WIDTH_PX = 800,
	REPORT_PICTURE_HEIGHT_PX = 600,
};

/* A level of the hierarchy; 0 is the coarsest. */
struct report_level {
	uint32_t group_count, patch_count, published_group_count;
	uint64_t triangle_count, bytes;
	/* of the picture in which this level is drawn everywhere: the largest of a group's, and the
	 * mean; 0 for the finest */
	double error_m, mean_error_m;
};

/* A place that takes much of the release: a face of a sampling point, or a group of patches. */
struct report_costly {
	uint64_t bytes;
	bool is_face;
	uint32_t point[3]; /* of a face */
	int face;
	uint32_t count;    /* of tiles or patches */
	float centre_m[3]; /* of what it shows */
};

struct report_face {
	uint32_t point[3];
	int face;
	uint16_t coverage;
	uint32_t tile_count;
	uint64_t bytes;
	struct buffer thumbnail; /* owned; WebP, empty for most */
};

enum report_picture { REPORT_MODEL, REPORT_PATCHES, REPORT_ABOVE, REPORT_PICTURES };

struct report_data {
	const struct report_options *options;
	const struct content *content;
	struct import_report *imports; /* owned */
	uint32_t import_count;         /* 0: not known */
	struct master *master;         /* owned */
	uint32_t level_count;
	struct report_level levels[REPORT_LEVELS_MAX];
	struct samples_store *store; /* owned */
	uint32_t states[SAMPLE_STATES];
	struct report_face *faces; /* owned */
	uint32_t face_count, face_room;
	/* for each point of the grid (x runs fastest) and each face: 1 + its number in faces, or 0;
	 * owned */
	uint32_t (*face_at)[CUBE_FACES];
	uint64_t tile_count;
	/* bytes of the release */
	uint64_t tile_bytes, patch_bytes, file_bytes;
	struct report_costly costly[REPORT_COSTLY_MAX]; /* the largest first */
	uint32_t costly_count;
	struct portrait portraits[REPORT_PICTURES];
	struct buffer pictures[REPORT_PICTURES]; /* owned; JPEG; empty: not drawn */
};

/* Negative errno; errors are logged. report_data_finish frees it in each case. */
must_check int report_data_read(struct report_data *out, const struct report_options *options);
void report_data_finish(struct report_data *data);
/* Returns the number of a point of the grid, for face_at. */
uint32_t report_data_point(const struct report_data *data, const uint32_t point[3]);

#endif
