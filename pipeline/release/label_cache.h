/* What labelling a release came to, kept beside the content until something it is made of changes:
 * it is most of the work of publishing another caption. */
#ifndef GOPURA_PIPELINE_RELEASE_LABEL_CACHE_H
#define GOPURA_PIPELINE_RELEASE_LABEL_CACHE_H

#include "base/bytes.h"
#include "format/hash.h"
#include "pipeline/content/content.h"
#include "pipeline/release/label_source.h"

/* Of everything that labels are made of: the scans, the published patches (the hierarchy page's
 * hash) and the parts. -EINVAL: as content_scans_key; -ENOMEM. */
must_check int label_cache_key(struct hash *out, const struct content *content,
			       struct hash hierarchy, const struct label_source_part *parts,
			       uint32_t part_count, struct fault *fault);

/* The objects of count groups, empty for a group without, into buffers that are initialised.
 * -ENOENT: none of that key and count are kept whole; the buffers are cleared then. */
must_check int label_cache_load(struct buffer *labels, uint32_t count, struct hash key,
				const char *path);
must_check int label_cache_save(const struct buffer *labels, uint32_t count, struct hash key,
				const char *path);

#endif
