/* Reads and checks the header of a PLY file. Private to pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_HEADER_H
#define GOPURA_PIPELINE_IMPORT_PLY_HEADER_H

#include <stddef.h>

#include "base/diagnostics.h"
#include "pipeline/import/ply.h"
#include "pipeline/import/ply_input.h"

enum {
	PLY_LINE_MAX = 4096, /* of a header line */
	PLY_HEADER_MAX = 1 << 20,
	PLY_ELEMENTS_MAX = 32,
	PLY_PROPERTIES_MAX = 128, /* per element */
	PLY_NAME_BYTES = 64,
};

enum ply_type {
	PLY_INT8,
	PLY_UINT8,
	PLY_INT16,
	PLY_UINT16,
	PLY_INT32,
	PLY_UINT32,
	PLY_FLOAT32,
	PLY_FLOAT64,
	PLY_TYPE_NONE,
};

/* Our meaning of a property. */
enum ply_slot {
	PLY_SLOT_X,
	PLY_SLOT_Y,
	PLY_SLOT_Z,
	PLY_SLOT_RED,
	PLY_SLOT_GREEN,
	PLY_SLOT_BLUE,
	PLY_SLOT_ALPHA,
	PLY_SLOT_U,
	PLY_SLOT_V,
	PLY_SLOT_NORMAL_X,
	PLY_SLOT_NORMAL_Y,
	PLY_SLOT_NORMAL_Z,
	PLY_SLOT_CONFIDENCE,
	PLY_SLOT_CORNERS,    /* list of vertex indices */
	PLY_SLOT_CORNER_UVS, /* list of u v u v ... */
	PLY_SLOT_TEXTURE,
	PLY_SLOT_NONE, /* skipped */
};

struct ply_property {
	char name[PLY_NAME_BYTES];
	enum ply_type type;       /* of the value, or of the items of a list */
	enum ply_type count_type; /* PLY_TYPE_NONE: not a list */
	enum ply_slot slot;
	uint32_t offset; /* bytes from the start of the element, if it has no list */
};

enum ply_kind { PLY_KIND_VERTEX, PLY_KIND_FACE, PLY_KIND_STRIP, PLY_KIND_GRID, PLY_KIND_OTHER };

struct ply_element {
	char name[PLY_NAME_BYTES];
	enum ply_kind kind;
	uint64_t count;
	uint32_t property_count;
	struct ply_property properties[PLY_PROPERTIES_MAX];
	uint32_t stride; /* bytes in binary; 0: ASCII, or it has a list */
};

enum ply_encoding { PLY_ASCII, PLY_LITTLE, PLY_BIG };

struct ply {
	char name[256]; /* name of the file in messages */
	struct ply_input input;
	enum ply_encoding encoding;
	uint32_t element_count;
	struct ply_element elements[PLY_ELEMENTS_MAX];
	struct ply_summary summary;
	char *textures[PLY_TEXTURES_MAX]; /* owned */
	bool gopura_open;
	uint64_t trailing, lines_skipped, triangles;
	/* Corners of the current polygon, PLY_CORNERS_MAX each; owned. */
	uint32_t *corners;
	float (*corner_uvs)[2];
	uint32_t corner_count, corner_uv_floats;
};

/* Returns the size of a binary value; 0 for PLY_TYPE_NONE. */
size_t ply_type_bytes(enum ply_type type);
/* Reads the header up to end_header. -EBADMSG with a diagnostic; -ENOMEM. */
must_check int ply_read_header(struct ply *ply, struct diagnostics *diagnostics);
/* After the header: checks that its declarations make sense and that the file is long enough.
 * -EBADMSG or -EFBIG with a diagnostic. */
must_check int ply_judge_header(struct ply *ply, struct diagnostics *diagnostics);

/* ---- ply.c */

/* Reads the place of the vertex that begins at that offset of the file, without reading what lies
 * before. element: binary vertices, of the summary's file. fd: the file. -EBADMSG: it is cut off;
 * errors of the disk. */
must_check int ply_place(float out[3], const struct ply *ply, const struct ply_element *element,
			 int fd, uint64_t offset);

#endif
