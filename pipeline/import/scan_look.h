/* A look at a scan's file that costs nothing: what its header and its size tell, and some of its
 * places. Used to predict what a build will cost. It refuses what the import would refuse without
 * having read the file. */
#ifndef GOPURA_PIPELINE_IMPORT_SCAN_LOOK_H
#define GOPURA_PIPELINE_IMPORT_SCAN_LOOK_H

#include "pipeline/import/import.h"

enum { SCAN_LOOK_PLACES_MAX = 4096 };

struct scan_look {
	const char *format; /* "PLY", "OBJ", ...; constant */
	uint64_t file_bytes;
	/* As the header says, or estimated from the size of the file: at least 1. */
	uint64_t triangle_count, vertex_count;
	bool is_points;    /* a PLY without faces, which import_scan refuses; triangle_count is 1 */
	bool is_counted;   /* the header says how many triangles there are */
	bool is_text;      /* numbers are text: slower to read */
	bool has_pictures; /* its colours come from pictures */
	bool has_colours;  /* per vertex; only of a PLY is this known */
	/* Vertices from all over the file, in metres with z up; of glTF, the corners of its boxes.
	 * There may be none. */
	uint32_t place_count;
	float places_m[SCAN_LOOK_PLACES_MAX][3];
};

/* Reads at most a few MB, however large the file is. Returns a negative errno with a diagnostic. */
must_check int scan_look(struct scan_look *out, const char *path,
			 const struct import_options *options, struct diagnostics *diagnostics);

#endif
