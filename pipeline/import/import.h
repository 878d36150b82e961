/* Reads a scan file into a repaired mesh in metres, z up. PLY is read by pipeline/import/ply.h,
 * VRML97 by pipeline/scene/vrml.h.
 * OBJ, STL, OFF and glTF are read by assimp in a child process with limits, so that a crash or hang
 * there becomes an error message here. docs/import.md says what is read and what is refused. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "base/diagnostics.h"
#include "pipeline/import/mesh.h"
#include "pipeline/import/mesh_repair.h"
#include "pipeline/import/transform.h"

enum import_axis { IMPORT_Z_UP, IMPORT_Y_UP, IMPORT_X_UP };

struct import_options {
	enum import_axis up;
	double metres_per_unit; /* 0: 1 m */
	/* of this scan, in the file's unit and axes; borrowed; NULL: it stays where it is */
	const struct transform *transform;
	uint8_t default_colour[3]; /* for a scan without colours; all 0: sandstone */
	bool override_colour;      /* use default_colour even if the scan has colours */
	/* wall-clock limit of a foreign parser; 0: depends on the file's size */
	uint32_t timeout_s;
	/* limit for a foreign parser and for the pictures of a PLY; 0: depends on the file's
	 * size */
	uint64_t memory_bytes;
	uint32_t jobs; /* number of threads; 0: one per core. The result does not depend on it */
};

struct import_report {
	char format[16];        /* "PLY", "OBJ", ... */
	bool had_colours;       /* the file has colours per vertex */
	bool had_open_sky;      /* alpha holds the open share of the sky */
	uint32_t textures;      /* decoded pictures */
	uint32_t strange_lines; /* skipped header lines */
	uint64_t trailing_bytes;
	uint64_t file_bytes;
	int64_t duration_ms;
	uint32_t vertices, triangles; /* of the result */
	float low_m[3], high_m[3];
	struct mesh_repairs repairs;
	struct diagnostics warning; /* the first thing that was tolerated with loss; "" if none */
};

enum scan_format {
	SCAN_PLY,
	SCAN_STL,
	SCAN_OFF,
	SCAN_OBJ,
	SCAN_GLTF,
	SCAN_GLB,
	SCAN_VRML,
	SCAN_UNKNOWN
};

/* Returns the name of a format as reports have it, such as "PLY". */
const char *import_format_name(enum scan_format format);
/* Detects the format of a file and measures it. Errors as import_scan. */
must_check int import_detect(enum scan_format *format, uint64_t *file_bytes, const char *path,
			     struct diagnostics *diagnostics);
/* Converts a place of the file to metres with z up, as import_scan does. */
void import_place(float out_m[3], const float from[3], const struct import_options *options);

/* Sets *out to what import_place does, as a matrix, for scans that are read by others. */
void import_transform(struct transform *out, const struct import_options *options);

/* *out is owned by the caller; it is zeroed on failure. The result always has colours: those of the
 * scan, of its textures, or the default. Open sky is 255 if the scan does not give it. Returns a
 * negative errno, and diagnostics names the file, the place and how to correct it. report may be
 * NULL. */
must_check int import_scan(struct mesh *out, const char *path, const struct import_options *options,
			   struct import_report *report, struct diagnostics *diagnostics);

/* Checks cheaply, by the first bytes, what import_scan would refuse: a format that is not read, a
 * PLY without faces or shorter than its header says, a glTF that requires an extension. Errors as
 * import_scan. */
must_check int import_check(const char *path, struct diagnostics *diagnostics);

/* Returns whether a file is a PLY of points without faces, so a range image or a cloud, which is no
 * surface, and sets *points to how many it has, or 0. Reads the header only; a file that cannot be
 * read is none. */
bool import_is_points(const char *path, uint64_t *points);

/* Returns whether a scan may name other files: 0 for STL, OFF, and a PLY without pictures; else 1,
 * also where it cannot be told; or the negative errno of a failure that may pass. Reads the header
 * only. */
must_check int import_names_files(const char *path);

/* Parses the name of an axis: "z", "y" or "x". False: not valid, and *out is unchanged. */
bool import_axis_named(const char *name, enum import_axis *out);
/* Parses a unit: "m", "cm", "mm", "in", or the metres in one unit, above 0 and at most 1e9. False:
 * not valid, and *out_metres is unchanged. */
bool import_unit_named(const char *name, double *out_metres);

#endif
