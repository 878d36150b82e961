/* A content folder: what its temple.ini says, and the mesh of its scans. docs/samples.md lists the
 * keys of [grid], docs/render.md the rest. */
#ifndef GOPURA_PIPELINE_FOLDER_H
#define GOPURA_PIPELINE_FOLDER_H

#include <limits.h>
#include <stdbool.h>

#include "base/fault.h"
#include "format/hash.h"
#include "pipeline/import.h"
#include "pipeline/mesh.h"

enum {
	FOLDER_SCANS_MOST = 64,
	FOLDER_LANGUAGES_MOST = 8,
	FOLDER_TEXT_BYTES = 256,
	FOLDER_DIR_BYTES = PATH_MAX - 512 /* so that names below it fit in PATH_MAX */
};

enum folder_colours { FOLDER_SCAN_COLOURS, FOLDER_PROCEDURAL, FOLDER_ONE_COLOUR };
enum folder_choice { FOLDER_BY_SCAN, FOLDER_NO, FOLDER_YES };

struct folder {
	char dir[FOLDER_DIR_BYTES];
	/* [model] */
	char name[128];
	uint32_t scan_count;
	char scans[FOLDER_SCANS_MOST][FOLDER_TEXT_BYTES]; /* relative to dir */
	struct import_options import;                     /* up, unit */
	enum folder_colours colours;
	uint8_t colour[3];      /* FOLDER_ONE_COLOUR, and of scans that have none; sRGB */
	enum folder_choice lit; /* by scan: lit unless it has textures; folder_lit answers */
	float sun[3];           /* unit vector towards the light */
	uint8_t background[3];  /* sRGB */
	/* [view]; has_start false: not said */
	bool has_start;
	float start_eye_m[3], start_target_m[3];
	/* [grid] */
	uint32_t grid_points; /* along the longest side, 2 .. 64 */
	uint32_t face_px;     /* finest: 128, 256, 512, 1024 or 2048 */
	uint32_t quality;     /* of JPEG, 1 .. 100 */
	bool below_ground;    /* points also below the lowest point of the model */
	/* [hierarchy] */
	bool tree; /* the paper's binary tree; else groups */
	uint32_t patch_triangles;
	/* [release] */
	double publish_share; /* of the scan's triangles, 0.001 .. 1 */
	uint32_t language_count;
	char languages[FOLDER_LANGUAGES_MOST][8];
};

/* Reads DIR/temple.ini. Negative errno, and fault names file, line and cure. */
must_check int folder_open(struct folder *out, const char *dir, struct fault *fault);

/* What the mesh is made of: the bytes of all scans and the options of their import. Files that a
 * scan refers to (materials, pictures) count by size and time. */
must_check int folder_mesh_key(const struct folder *folder, struct hash *key, struct fault *fault);
/* All scans as one mesh, from DIR/.work/mesh if it is there with that key, else imported and kept
 * there. *out is owned by the caller; zeroed on failure. */
must_check int folder_mesh(const struct folder *folder, struct mesh *out, struct hash *key,
			   struct fault *fault);
/* Is this folder's mesh drawn with light? */
bool folder_lit(const struct folder *folder, const struct mesh *mesh);

/* Makes DIR/.work and, unless below is NULL, DIR/.work/below. */
must_check int folder_make_work(const struct folder *folder, const char *below);

#endif
