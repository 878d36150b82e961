/* A scan file into a repaired mesh in metres, z up. PLY is read by pipeline/import/ply.h; OBJ, STL,
 * OFF and glTF by assimp, in a child process with limits, so that what crashes or hangs there is an
 * error message here. docs/import.md says what is read and what is refused. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "base/fault.h"
#include "pipeline/import/mesh.h"
#include "pipeline/import/mesh_repair.h"

enum import_axis { IMPORT_Z_UP, IMPORT_Y_UP, IMPORT_X_UP };

struct import_options {
	enum import_axis up;
	double metres_per_unit;    /* 0: 1 */
	uint8_t default_colour[3]; /* of a scan without colours; all 0: sandstone */
	bool override_colour;      /* default_colour also where the scan has its own */
	uint32_t timeout_s;        /* wall clock of a foreign parser; 0: by the file's size */
	uint64_t memory_bytes;     /* of a foreign parser, of PLY pictures; 0: by the file's size */
};

struct import_report {
	char format[16];        /* "PLY", "OBJ", ... */
	bool had_colours;       /* of its own, per vertex */
	bool had_open_sky;      /* alpha is the open share of the sky */
	uint32_t textures;      /* pictures decoded */
	uint32_t strange_lines; /* header lines skipped */
	uint64_t trailing_bytes;
	uint64_t file_bytes;
	int64_t duration_ms;
	uint32_t vertices, triangles; /* of the result */
	float low_m[3], high_m[3];
	struct mesh_repairs repairs;
	struct fault warning; /* the first thing that was tolerated with loss, "" if none */
};

/* *out is owned by the caller; zeroed on failure. The result always has colours: the scan's, its
 * textures' or the default; open sky is 255 where the scan does not say. Negative errno, and fault
 * names file, place and cure. report may be NULL. */
must_check int import_scan(struct mesh *out, const char *path, const struct import_options *options,
			   struct import_report *report, struct fault *fault);

/* "z", "y", "x"; and "m", "cm", "mm", "in" or metres in one unit, above 0 and finite. False: it is
 * none of these, and *out is unchanged. */
bool import_axis_named(const char *name, enum import_axis *out);
bool import_unit_named(const char *name, double *out_metres);

/* For people: a line each for what was read and for what was repaired. */
void import_report_print(FILE *to, const char *path, const struct import_report *report);

#endif
