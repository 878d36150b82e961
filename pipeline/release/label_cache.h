/* Caches the labels of a release beside the content until something they depend on changes.
 * Labelling would otherwise take most of the time of publishing, say, a new caption. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_CACHE_H
#define GOPURA_PIPELINE_RELEASE_LABEL_CACHE_H

#include "base/bytes.h"
#include "format/hash.h"
#include "pipeline/release/label_source.h"

/* Hashes everything that labels depend on: the scans, the published patches (the hierarchy page's
 * hash) and the parts. Returns -ENOMEM. */
must_check int label_cache_key(struct hash *out, struct hash scans, struct hash hierarchy,
			       const struct label_source_part *parts, uint32_t part_count);

/* Loads the objects of count groups into initialised buffers; empty for a group without labels.
 * Returns -ENOENT if the cache does not have that key and count, complete; the buffers are then
 * cleared. */
must_check int label_cache_load(struct buffer *labels, uint32_t count, struct hash key,
				const char *path);
/* Writes the cache file. Returns -ENOMEM, -EFBIG or the errors of the disk. */
must_check int label_cache_save(const struct buffer *labels, uint32_t count, struct hash key,
				const char *path);

#endif
