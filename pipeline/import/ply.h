/* Streaming reader of PLY scans (Greg Turk's format, 1994): ASCII, binary of either byte order,
 * any order and type of properties, unknown elements and properties skipped. Memory does not grow
 * with the file: one buffer, and the corners of one polygon.
 *
 * Polygons come as fans of triangles, triangle strips (element tristrips, -1 starts anew) as
 * triangles. Indices are checked against the vertex count; coordinates may be anything a float
 * can be. docs/import.md lists names and limits. One thread a reader. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_H
#define GOPURA_PIPELINE_IMPORT_PLY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/fault.h"

enum {
	PLY_TEXTURES_MAX = 256,
	PLY_CORNERS_MAX = 65536, /* of one polygon */
};

struct ply; /* private to ply*.c */

/* What the header promises. */
struct ply_summary {
	uint64_t vertex_count; /* at most UINT32_MAX - 1 */
	uint64_t face_count;   /* polygons and strips */
	bool has_colour;       /* per vertex */
	bool has_open_sky;     /* alpha is the open share of the sky ("comment gopura open") */
	bool has_uv;           /* per vertex */
	bool has_corner_uv;    /* per corner of a face */
	bool is_ascii;
	uint32_t texture_count;
	const char *const
		*textures;       /* names from "comment TextureFile"; borrowed from the reader */
	uint32_t strange_lines;  /* header lines that were not understood, and skipped */
	const char *points_only; /* why there are no faces, or NULL */
};

struct ply_vertex {
	double position[3]; /* in the file's unit and axes */
	uint8_t colour[4];  /* sRGB and open sky; 255 where the file has none */
	float uv[2];        /* as in the file: v = 0 at the bottom; 0 where it has none */
};

struct ply_triangle {
	uint32_t corner[3]; /* each below vertex_count */
	float uv[3][2];     /* where has_corner_uv */
	uint32_t texture;   /* texnumber; 0 where the file has none */
	uint32_t face;      /* the face or strip it is of, from 0 */
};

/* Called in file order. What they return other than 0 ends the reading and is its result. */
struct ply_visitor {
	void *data;
	int (*vertex)(void *data, const struct ply_vertex *vertex);
	int (*triangle)(void *data, const struct ply_triangle *triangle);
};

/* Opens and reads the header. *out is owned by the caller; NULL on failure. -EBADMSG: not a PLY
 * that can be read, or shorter than its header says; -ENOENT and kin: the file. */
must_check int ply_open(struct ply **out, const char *path, struct fault *fault);
/* The same from an open descriptor, which is taken (closed with the reader, or on failure). */
must_check int ply_open_fd(struct ply **out, int fd, const char *name, struct fault *fault);
void ply_close(struct ply *ply); /* NULL is fine */

const struct ply_summary *ply_summary(const struct ply *ply); /* borrowed */

/* Everything after the header, once. */
must_check int ply_read(struct ply *ply, const struct ply_visitor *visitor, struct fault *fault);

uint64_t ply_bytes_read(const struct ply *ply);
uint64_t ply_bytes_total(const struct ply *ply); /* size of the file */
/* After ply_read: bytes behind the last element; they were ignored. */
uint64_t ply_bytes_trailing(const struct ply *ply);

#endif
