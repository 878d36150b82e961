/* A content folder: its temple.ini, read, completed with defaults and checked. docs/content.md
 * lists the keys. */
#ifndef GOPURA_PIPELINE_CONTENT_CONTENT_H
#define GOPURA_PIPELINE_CONTENT_CONTENT_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include "base/diagnostics.h"
#include "base/settings.h"
#include "format/hash.h"
#include "format/tile.h"
#include "geometry/substance.h"
#include "pipeline/content/content_name.h"
#include "pipeline/import/import.h"

enum {
	CONTENT_PATH_BYTES = 4096,
	CONTENT_SCANS_MAX = MESH_SCANS_MAX,
	CONTENT_LANGUAGES_MAX = 64,
	CONTENT_LANGUAGE_BYTES = 12,
	CONTENT_TARGET_BYTES = 97, /* what a terminal takes */
	CONTENT_ROLE_BYTES = 65,
};

enum content_colours {
	CONTENT_COLOURS_SCAN,
	CONTENT_COLOURS_PROCEDURAL, /* a material: substance */
	CONTENT_COLOURS_ONE,        /* one colour for all: import.default_colour */
};

enum content_lit {
	CONTENT_LIT_AUTO, /* yes, except for textured scans, whose pictures contain their light */
	CONTENT_LIT_NO,
	CONTENT_LIT_YES,
};

/* What of the scans is published. */
enum content_surface {
	CONTENT_SURFACE_SCAN,   /* their faces */
	CONTENT_SURFACE_OCTREE, /* one closed surface around them: pipeline/octree/closed_surface.h
				 */
};

/* Which tiles of a release with a budget get a better quality. */
enum content_quality_rule {
	CONTENT_QUALITY_GAIN,     /* those where a byte gains most similarity */
	CONTENT_QUALITY_UNIFORM,  /* all alike */
	CONTENT_QUALITY_FEATURES, /* those with more feature points */
};

/* Folders beside temple.ini that hold what is written about the parts; NULL ends the list. */
extern const char *const content_folders[];

struct content {
	char folder[CONTENT_PATH_BYTES]; /* as given, without a trailing slash */
	uint64_t settings_bytes;         /* of temple.ini, looked at before it was read */
	struct timespec settings_time;   /* likewise, when it was changed last */
	char name[128];                  /* UTF-8; by default the name of the folder */
	char *scans[CONTENT_SCANS_MAX];  /* paths including the folder; owned */
	struct transform *transforms[CONTENT_SCANS_MAX]; /* of each scan; owned; NULL: none */
	uint32_t scan_count;                             /* at least 1 */
	struct import_options import;
	enum content_colours colours;
	enum substance_kind substance; /* SUBSTANCE_NONE: the weathered stone of the demo temple */
	enum substance_kind cut; /* what a section shows of solid matter; SUBSTANCE_NONE: red */
	enum content_lit lit;
	float sun[3]; /* unit vector towards the light */
	uint8_t background[3];
	bool has_start;
	float start_eye_m[3], start_target_m[3]; /* valid if has_start */
	unsigned tools;       /* tools that visitors have; bits of enum info_tool */
	double error_mm;      /* a point of the scan may be so far from the surface; 0: not known */
	uint32_t grid_points; /* 4..32, along the longest side of the bounding box */
	uint32_t face_px;     /* size of the finest sampling face: 128, 256 ... 4096 */
	uint32_t quality;     /* 1..100 */
	enum tile_effort effort; /* of tiles */
	uint64_t budget_bytes;   /* of the whole release; 0: none. Not in temple.ini */
	enum content_quality_rule quality_rule;
	enum content_surface surface;
	double cell_mm;           /* leaf cubes of surfaces that are made; 0: by the scans */
	bool binary_tree;         /* the paper's binary hierarchy instead of groups */
	bool simplify_features;   /* levels keep feature edges; else by quadrics */
	uint32_t patch_triangles; /* 256..4000; 0: depends on the size of the scan */
	uint32_t block_triangles; /* of the scan in one block, 2000..16000000; 0: the default */
	double lattice_mm;        /* the largest step of the lattice, 0.05..100; 0: the default */
	bool tuf_alone;           /* releases are in the form of The Update Framework alone */
	/* Path among its targets, and the role that signs it; "": release.json, the top. */
	char tuf_target[CONTENT_TARGET_BYTES], tuf_role[CONTENT_ROLE_BYTES];
	double publish_share; /* share of the scan's triangles; above 0, at most 1 */
	uint32_t language_count;
	/* the first is the default */
	char languages[CONTENT_LANGUAGES_MAX][CONTENT_LANGUAGE_BYTES];
};

/* Reads FOLDER/temple.ini. The scans must exist. On failure *out is zeroed, and diagnostics has
 * every fault of the file with its line and how to correct it. -EINVAL, -ENOMEM, and the errors of
 * reading a file. content_release frees it. */
must_check int content_read(struct content *out, const char *folder,
			    struct diagnostics *diagnostics);
void content_release(struct content *content); /* Frees the contents. NULL and zeroed are fine. */

/* Builds FOLDER/NAME. -EINVAL: name is not safe. -ENAMETOOLONG. */
must_check int content_file_path(const struct content *content, const char *name,
				 char out[CONTENT_PATH_BYTES]);
/* Builds FOLDER/.work/NAME and creates .work if missing. -EINVAL, -ENAMETOOLONG, or the error of
 * mkdir. */
must_check int content_work_path(const struct content *content, const char *name,
				 char out[CONTENT_PATH_BYTES]);

/* Returns whether the model is lit; "auto" depends on whether it has the colours of pictures, which
 * hold their light. has_pictures: struct scans_shape's had_pictures. */
bool content_is_lit(const struct content *content, bool has_pictures);
/* Returns whether a name may be that of a role ([release] role). */
bool content_role_is_valid(const char *name);
/* What such a name is, for messages. */
extern const char content_role_rule[];

#endif
