/* The entropy coding of a streaming mesh (format/stream.h): base and records, by the adaptive
 * models of symbol_coder.h. One function serves both directions. Private to format/. */
#ifndef GOPURA_FORMAT_STREAM_CODE_H
#define GOPURA_FORMAT_STREAM_CODE_H

#include "format/precision.h"
#include "format/predict.h"
#include "format/stream_mesh.h"
#include "format/symbol_coder.h"

enum { STREAM_MOVED_MODELS = 81, STREAM_FACE_MODELS = 9 };

/* All zeros but coder and precision at the beginning. The models go on from block to block. */
struct stream_coder {
	struct symbol_coder coder;
	struct vertex_precision precision;
	uint32_t last_target;
	struct symbol_model kind, gap, corner, piece_size;
	struct symbol_model moved[STREAM_MOVED_MODELS], faces[STREAM_FACE_MODELS];
	struct symbol_model positions[PREDICT_POSITION_MODELS], normals[2];
	struct symbol_model greens[PREDICT_COLOUR_MODELS], tints[2], opens[PREDICT_OPEN_MODELS];
};

/* Codes the triangles and vertices of a base; decoding, the mesh is empty and gets them. Returns
 * -EBADMSG if they are none. */
must_check int stream_code_base(struct stream_coder *coder, struct stream_mesh *mesh,
				uint32_t vertex_count, uint32_t triangle_count);
/* Codes a record and its vertices (vertices[] from vertex_count on), and applies it. Returns
 * -EBADMSG if it is none; the mesh is then as before. */
must_check int stream_code_record(struct stream_coder *coder, struct stream_mesh *mesh,
				  struct stream_record *record);

#endif
