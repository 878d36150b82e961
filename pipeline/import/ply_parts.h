/* Shared by the sources of the PLY reader. Private to pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_PARTS_H
#define GOPURA_PIPELINE_IMPORT_PLY_PARTS_H

#include "pipeline/import/ply.h"

#include <stddef.h>

enum {
	PLY_BUFFER_BYTES = 1 << 18,
	PLY_LINE_MAX = 4096, /* of a header line */
	PLY_HEADER_MAX = 1 << 20,
	PLY_ELEMENTS_MAX = 32,
	PLY_PROPERTIES_MAX = 128, /* per element */
	PLY_NAME_BYTES = 64,
	PLY_TOKEN_BYTES = 128, /* text of one ASCII number */
};

/* ---- ply_input.c: reads a file through one fixed buffer */

struct ply_input {
	int fd;
	uint8_t *buffer; /* owned */
	size_t at, end;
	uint64_t base;       /* file offset of buffer[0] */
	uint64_t file_bytes; /* from fstat */
	/* line number of the next byte, from 1; counted in the header and in ASCII bodies */
	uint64_t line;
	int error; /* error of read(2); kept */
};

/* fd is taken, even on failure; call ply_input_finish. -EISDIR, -ESPIPE: not a regular file.
 * -ENOMEM. */
must_check int ply_input_init(struct ply_input *input, int fd);
/* Closes the descriptor and frees the buffer. */
void ply_input_finish(struct ply_input *input);
/* Consumes the next `size` bytes (size <= PLY_BUFFER_BYTES) and returns a view of them, borrowed
 * until the next call. NULL: fewer bytes are left. */
const uint8_t *ply_input_take(struct ply_input *input, size_t size);
/* Returns the next byte without consuming it; -1 at the end. */
int ply_input_peek(struct ply_input *input);
/* Returns the file offset of the next byte. */
uint64_t ply_input_offset(const struct ply_input *input);

enum ply_token {
	PLY_TOKEN_NUMBER,
	PLY_TOKEN_LINE_END, /* the line has no further number; the line end is not consumed */
	PLY_TOKEN_BAD,      /* not a number; text holds what was found */
	PLY_TOKEN_FILE_END,
};

/* Reads the next number of an ASCII body. It skips line ends only if cross_lines is set. */
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

enum ply_kind { PLY_KIND_VERTEX, PLY_KIND_FACE, PLY_KIND_STRIP, PLY_KIND_OTHER };

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
	bool cr_only;                     /* lines end with CR alone */
	bool gopura_open, range_grid;
	uint64_t trailing, lines_skipped;
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

#endif
