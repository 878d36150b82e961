/* The files of the sample store: a sealed frame around the contents, and the summary of a point's
 * file, which has the tiles' hashes in place of their bytes. docs/samples.md has the bytes. */
#ifndef GOPURA_PIPELINE_SAMPLES_SAMPLE_FILE_H
#define GOPURA_PIPELINE_SAMPLES_SAMPLE_FILE_H

#include "format/hash.h"
#include "pipeline/samples/sample_store.h"

/* Magic, version and key; then come the contents, then a hash of everything before. */
enum { SAMPLE_FILE_HEAD_BYTES = 8 + HASH_BYTES, SAMPLE_FILE_BYTES_MAX = 512 << 20 };

/* Begins and ends a file in an initialised buffer, whose error tells whether it fitted. */
void sample_file_begin(struct buffer *file, const char magic[4], struct hash key);
void sample_file_seal(struct buffer *file);
/* Checks the frame and leaves the reader at the contents. Returns false if the file is damaged or
 * of another kind. */
bool sample_file_open(struct reader *reader, struct bytes file, const char magic[4],
		      struct hash *key);

/* Writes the contents of the file of a point of this grid. */
void sample_file_put_point(struct buffer *file, const struct sample_grid *grid,
			   enum sample_state state, const struct sample_face *faces,
			   uint32_t face_count);

/* Appends the summary of the contents of a point's file. -EBADMSG: the contents are damaged;
 * out->error otherwise. */
must_check int sample_file_summarize(struct buffer *out, struct reader *contents,
				     const struct sample_grid *grid);

/* Reads a summary face by face. */
struct sample_summary {
	struct reader reader;
	uint32_t choice_count, scale_count;
	enum sample_state state;
	uint32_t faces_left;
	uint64_t at; /* in the point's file, of what follows */
	uint16_t tiles[FACE_TILES_MAX];
	uint32_t sizes[FACE_TILES_MAX];
	struct hash hashes[FACE_TILES_MAX];
	uint64_t offsets[FACE_TILES_MAX];
	uint32_t choice_sizes[FACE_TILES_MAX * SAMPLE_CHOICES_MAX];
	uint32_t losses[FACE_TILES_MAX * SAMPLE_CHOICES_MAX];
	uint16_t windows[FACE_TILES_MAX];
	uint32_t features[FACE_TILES_MAX][SAMPLE_SCALES_MAX];
};

/* Begins; bytes are borrowed until the last face was read. Returns false if it is damaged. */
bool sample_summary_open(struct sample_summary *summary, struct bytes bytes,
			 const struct sample_grid *grid);
/* Reads the next face, but for point and path. choices: the quality of each of its tiles, of which
 * there are at most choices_left; tiles beyond have the best one. *out borrows from summary until
 * the next call. Returns false if it is damaged. faces_left must not be 0. */
bool sample_summary_next(struct sample_summary *summary, struct sample_face *out,
			 const uint8_t *choices, uint32_t choices_left);

#endif
