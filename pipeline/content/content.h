/* A content folder: temple.ini, read, completed with defaults and judged. docs/content.md lists
 * the keys. */
#ifndef GOPURA_PIPELINE_CONTENT_CONTENT_H
#define GOPURA_PIPELINE_CONTENT_CONTENT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/fault.h"
#include "format/hash.h"
#include "pipeline/import/import.h"

enum {
	CONTENT_PATH_BYTES = 4096,
	CONTENT_SCANS_MAX = 64,
	CONTENT_LANGUAGES_MAX = 64,
	CONTENT_LANGUAGE_BYTES = 12,
};

enum content_colours {
	CONTENT_COLOURS_SCAN,
	CONTENT_COLOURS_PROCEDURAL, /* the stone function of the demo temple */
	CONTENT_COLOURS_ONE,        /* one for all: import.default_colour */
};

enum content_lit {
	CONTENT_LIT_AUTO, /* yes but for textured scans, whose pictures hold their light */
	CONTENT_LIT_NO,
	CONTENT_LIT_YES,
};

struct content {
	char folder[CONTENT_PATH_BYTES]; /* as given, without a slash at its end */
	char name[128];                  /* UTF-8; by default the folder's name */
	char *scans[CONTENT_SCANS_MAX];  /* paths, folder included; owned */
	uint32_t scan_count;             /* at least 1 */
	struct import_options import;
	enum content_colours colours;
	enum content_lit lit;
	float sun[3]; /* unit vector towards the light */
	uint8_t background[3];
	bool has_start;
	float start_eye_m[3], start_target_m[3]; /* where has_start */
	unsigned tools;                          /* of enum info_tool, that visitors have */
	uint32_t grid_points;                    /* 4..32, along the longest side of the box */
	uint32_t face_px;         /* of a sampling face at its finest: 128, 256 ... 4096 */
	uint32_t quality;         /* 1..100 */
	bool binary_tree;         /* the paper's hierarchy, not groups */
	uint32_t patch_triangles; /* 256..4000; 0: by the size of the scan */
	double publish_share;     /* of the scan's triangles; above 0, at most 1 */
	uint32_t language_count;
	char languages[CONTENT_LANGUAGES_MAX][CONTENT_LANGUAGE_BYTES]; /* the first is default */
};

/* Reads FOLDER/temple.ini; the scans must be there. Fault names file, line and cure. *out is
 * zeroed on failure; content_release releases it. */
must_check int content_read(struct content *out, const char *folder, struct fault *fault);
void content_release(struct content *content); /* NULL and zeroed are fine */

/* Relative, below the folder ("..", absolute paths and empty names are not), printable. What the
 * files of a content folder say about others must be so. */
bool content_name_is_safe(const char *name);
/* The folder, then name. -EINVAL where name is not safe; -ENAMETOOLONG. */
must_check int content_file_path(const struct content *content, const char *name,
				 char out[CONTENT_PATH_BYTES]);
/* The folder, then .work, then name; makes .work where it is missing. */
must_check int content_work_path(const struct content *content, const char *name,
				 char out[CONTENT_PATH_BYTES]);

/* Of what the scans are made: names, sizes, times of change, of the files beside them too (mtl,
 * pictures, buffers), and of how they are read. Equal key, equal mesh. */
must_check int content_scans_key(const struct content *content, struct hash *out,
				 struct fault *fault);

struct content_scans {
	bool from_cache;       /* nothing was read anew; reports are empty */
	uint32_t report_count; /* scan_count, unless from_cache */
	struct import_report reports[CONTENT_SCANS_MAX];
};

/* All scans in one mesh: from .work/mesh where that is of the same key, else imported, repaired
 * and saved there. *out is owned by the caller. scans may be NULL. */
must_check int content_import(struct mesh *out, const struct content *content,
			      struct content_scans *scans, struct fault *fault);

/* lit with "auto" decided. */
bool content_is_lit(const struct content *content, const struct mesh *mesh);

#endif
