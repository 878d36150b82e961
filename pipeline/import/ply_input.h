/* Reads a PLY file through one fixed buffer. Private to pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_INPUT_H
#define GOPURA_PIPELINE_IMPORT_PLY_INPUT_H

#include "base/compiler.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
	PLY_BUFFER_BYTES = 1 << 18,
	PLY_TOKEN_BYTES = 128, /* text of one ASCII number */
};

struct ply_input {
	int fd;
	uint8_t *buffer; /* owned */
	size_t at, end;
	uint64_t base;       /* file offset of buffer[0] */
	uint64_t file_bytes; /* from fstat */
	/* line number of the next byte, from 1; counted in the header and in ASCII bodies */
	uint64_t line;
	bool cr_only; /* lines end with CR alone; set by the header */
	int error;    /* error of read(2); kept */
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

/* Continues at that file offset. The line number stays. Negative errno. */
must_check int ply_input_seek(struct ply_input *input, uint64_t offset);

enum ply_token {
	PLY_TOKEN_NUMBER,
	PLY_TOKEN_LINE_END, /* the line has no further number; the line end is not consumed */
	PLY_TOKEN_BAD,      /* not a number; text holds what was found */
	PLY_TOKEN_FILE_END,
};

/* Reads the next number of an ASCII body. It skips line ends only if cross_lines is set. */
enum ply_token ply_input_number(struct ply_input *input, bool cross_lines, double *out,
				char text[PLY_TOKEN_BYTES]);

#endif
