/* Streaming reader of PLY scans (Greg Turk's format, 1994): ASCII, or binary in either byte order;
 * properties in any order and of any type; unknown elements and properties are skipped. Memory does
 * not grow with the file: a buffer for each thread, and the corners of one polygon.
 *
 * Polygons are delivered as fans of triangles, and triangle strips (element tristrips, where -1
 * starts a new strip) as triangles. Indices are checked against the vertex count. Coordinates may
 * have any float value, even a non-finite one. docs/import.md lists names and limits. Each reader
 * belongs to one thread, which may let others read with it. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_H
#define GOPURA_PIPELINE_IMPORT_PLY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "base/diagnostics.h"

enum {
	PLY_TEXTURES_MAX = 256,
	PLY_CORNERS_MAX = 65536, /* of one polygon */
};

struct ply; /* private to ply*.c */

/* What the header declares. */
struct ply_summary {
	uint64_t vertex_count; /* at most UINT32_MAX - 1 */
	uint64_t face_count;   /* polygons and strips */
	bool has_colour;       /* per vertex */
	bool has_open_sky;     /* alpha holds the open share of the sky ("comment gopura open") */
	bool has_uv;           /* per vertex */
	bool has_corner_uv;    /* per corner of a face */
	bool has_normal;       /* per vertex */
	bool has_confidence;   /* per vertex */
	/* From "obj_info num_cols" and "num_rows", which range images have; 0: not said. */
	uint32_t grid_columns, grid_rows;
	uint64_t grid_cells; /* of the element range_grid; 0: there is none */
	bool is_ascii;
	uint32_t texture_count;
	/* Names from "comment TextureFile"; borrowed from the reader. */
	const char *const *textures;
	uint32_t strange_lines;  /* header lines that were not understood and were skipped */
	const char *points_only; /* the reason why there are no faces, or NULL */
};

struct ply_vertex {
	double position[3]; /* in the file's unit and axes */
	uint8_t colour[4];  /* sRGB and open sky; 255 if the file has none */
	float uv[2];        /* as in the file: v = 0 at the bottom; 0 if it has none */
	float normal[3];    /* as in the file, of any length; 0 if it has none */
	float confidence;   /* as in the file; 1 if it has none */
};

struct ply_triangle {
	uint32_t corner[3]; /* each below vertex_count */
	float uv[3][2];     /* only if has_corner_uv */
	uint32_t texture;   /* texnumber; 0 if the file has none */
	uint32_t face;      /* number of its face or strip, from 0 */
};

/* Arguments are borrowed for the call. index counts the vertices and the triangles of the file. A
 * negative result ends the reading and becomes its result. Calls come in file order, with one
 * exception: from up to jobs threads at a time, in any order, for binary vertices without lists and
 * for the triangles at the start of binary faces. Where these are followed by a face that is no
 * triangle, some triangles with an index below the file's face count are delivered that are none;
 * those that belong there are delivered afterwards. */
struct ply_visitor {
	void *data;
	int (*vertex)(void *data, uint32_t index, const struct ply_vertex *vertex);
	int (*triangle)(void *data, uint64_t index, const struct ply_triangle *triangle);
	/* Another so many bytes of the file were read; NULL: not wanted. */
	void (*advance)(void *data, uint64_t bytes);
	uint32_t jobs; /* number of threads; 0: only the caller's */
	/* A cell of a range image, row by row: the vertex seen there, or -1. NULL: not wanted. */
	int (*cell)(void *data, uint64_t index, int64_t vertex);
};

/* Opens the file and reads its header. *out is owned by the caller; it is NULL on failure.
 * -EBADMSG: not a readable PLY, or shorter than its header says. -ENOENT and others: the file
 * cannot be opened. diagnostics says why. */
must_check int ply_open(struct ply **out, const char *path, struct diagnostics *diagnostics);
/* The same from an open descriptor. It is taken: closed with the reader, or on failure. name is
 * used in messages. */
must_check int ply_open_fd(struct ply **out, int fd, const char *name,
			   struct diagnostics *diagnostics);
void ply_close(struct ply *ply); /* NULL is fine */

/* What the header declares; borrowed from the reader. */
const struct ply_summary *ply_summary(const struct ply *ply);

/* Reads everything after the header. Call it once. Returns 0, or a negative errno, with a
 * diagnostic unless it is what a visitor returned. */
must_check int ply_read(struct ply *ply, const struct ply_visitor *visitor,
			struct diagnostics *diagnostics);

uint64_t ply_bytes_total(const struct ply *ply); /* size of the file in bytes */
/* After ply_read: number of triangles; each below it was delivered. */
uint64_t ply_triangles(const struct ply *ply);
/* After ply_read: number of edges, and of faces with less than three corners; they are skipped. */
uint64_t ply_lines_skipped(const struct ply *ply);
/* After ply_read: number of bytes after the last element; they were ignored. */
uint64_t ply_bytes_trailing(const struct ply *ply);

#endif
