/* What the sources of the PLY reader share. Private to pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_PARTS_H
#define GOPURA_PIPELINE_IMPORT_PLY_PARTS_H

#include "pipeline/import/ply.h"

#include <stddef.h>

enum {
	PLY_BUFFER_BYTES = 1 << 18,
	PLY_LINE_MAX = 4096, /* of the header */
	PLY_HEADER_MAX = 1 << 20,
	PLY_ELEMENTS_MAX = 32,
	PLY_PROPERTIES_MAX = 128, /* of one element */
	PLY_NAME_BYTES = 64,
	PLY_TOKEN_BYTES = 128, /* of one ASCII number */
};

/* ---- ply_input.c: a file through one fixed buffer */

struct ply_input {
	int fd;
	uint8_t *buffer; /* owned */
	size_t at, end;
	uint64_t base;       /* offset in the file of buffer[0] */
	uint64_t file_bytes; /* by stat */
	uint64_t line;       /* of the next byte, from 1; counted in header and ASCII */
	int error;           /* of read(2), sticky */
};

must_check int ply_input_init(struct ply_input *input, int fd);
void ply_input_finish(struct ply_input *input);
/* A view of the next size bytes (size <= PLY_BUFFER_BYTES), consumed; NULL when fewer are left.
 * Borrowed until the next call. */
const uint8_t *ply_input_take(struct ply_input *input, size_t size);
/* The next byte without consuming it; -1 at the end. */
int ply_input_peek(struct ply_input *input);
uint64_t ply_input_offset(const struct ply_input *input);

enum ply_token {
	PLY_TOKEN_NUMBER,
	PLY_TOKEN_LINE_END, /* the line has no further one; nothing is consumed */
	PLY_TOKEN_BAD,      /* not a number; text says what stands there */
	PLY_TOKEN_FILE_END,
};

/* The next number of an ASCII body; crosses line ends only if asked. */
enum ply_token ply_input_number(struct ply_input *input, bool cross_lines, double *out,
				char text[PLY_TOKEN_BYTES]);

/* ---- ply_header.c */

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

/* What a property means to us. */
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
	PLY_SLOT_CORNERS,    /* list of vertex indices */
	PLY_SLOT_CORNER_UVS, /* list of u v u v ... */
	PLY_SLOT_TEXTURE,
	PLY_SLOT_NONE, /* skipped */
};

struct ply_property {
	char name[PLY_NAME_BYTES];
	enum ply_type type;       /* of the value, or of the list's items */
	enum ply_type count_type; /* PLY_TYPE_NONE: not a list */
	enum ply_slot slot;
	uint32_t offset; /* bytes from the element's start, where the element has no list */
};

enum ply_kind { PLY_KIND_VERTEX, PLY_KIND_FACE, PLY_KIND_STRIP, PLY_KIND_OTHER };

struct ply_element {
	char name[PLY_NAME_BYTES];
	enum ply_kind kind;
	uint64_t count;
	uint32_t property_count;
	struct ply_property properties[PLY_PROPERTIES_MAX];
	uint32_t stride; /* bytes in binary; 0: it holds a list */
};

enum ply_encoding { PLY_ASCII, PLY_LITTLE, PLY_BIG };

struct ply {
	char name[256]; /* of the file, as faults call it */
	struct ply_input input;
	enum ply_encoding encoding;
	uint32_t element_count;
	struct ply_element elements[PLY_ELEMENTS_MAX];
	struct ply_summary summary;
	char *textures[PLY_TEXTURES_MAX]; /* owned */
	bool cr_only;                     /* how header lines end */
	bool gopura_open, range_grid;
	uint64_t trailing;
	/* corners of the polygon at hand, PLY_CORNERS_MAX each; owned */
	uint32_t *corners;
	float (*corner_uvs)[2];
	uint32_t corner_count, corner_uv_floats;
};

size_t ply_type_bytes(enum ply_type type);
must_check int ply_read_header(struct ply *ply, struct fault *fault);
/* After the header: does the body make sense, and is the file long enough for it? */
must_check int ply_judge_header(struct ply *ply, struct fault *fault);

#endif
