/* Makes the streaming mesh of a release: what a kiosk shows before it has patches (paper P3,
 * section 3.6; docs/stream.md). */
#ifndef GOPURA_PIPELINE_RELEASE_PUBLISH_STREAM_H
#define GOPURA_PIPELINE_RELEASE_PUBLISH_STREAM_H

#include "format/root_page.h"
#include "pipeline/hierarchy/stream_encode.h"
#include "pipeline/release/object_store.h"

enum {
	STREAM_CUT_TRIANGLES = 6000 /* of the cut that it reproduces, at most */
};

/* How the published stream is made (docs/stream.md has the figures). */
extern const struct stream_options stream_publish_options;

/* The mesh of a published cut: positions are rounded to what its error allows, vertices of one
 * place are one, and no triangle is flat or there twice. */
struct stream_cut {
	uint32_t group_count; /* the cut: so many first groups are refined */
	uint32_t vertex_count, triangle_count;
	struct patch_vertex *vertices; /* owned */
	uint32_t (*triangles)[3];      /* owned */
};

/* Reads the cut of the published hierarchy with the most groups within most_triangles, or of group
 * 0 alone. hierarchy is the hierarchy page in objects. Returns -ENOMEM, or the errors of
 * reading; *out is owned by the caller, zeroed on failure. */
must_check int stream_cut_read(struct stream_cut *out, struct object_store *objects,
			       const struct lattice *lattice, const struct page_child *hierarchy,
			       uint32_t most_triangles);
void stream_cut_finish(struct stream_cut *cut); /* zeroed is fine */

/* Adds the stream page and its blocks. Returns 1 if *out is set, 0 if the cut is too large for one
 * mesh or cannot be encoded; a release needs no stream. Errors are logged. */
must_check int publish_stream(struct object_store *objects, const struct lattice *lattice,
			      const struct page_child *hierarchy, struct page_child *out);

#endif
