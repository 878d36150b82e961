/* Copies and frees the texts of parts. */
#include "ui/parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int parts_copy(struct parts *out, const struct overlay_part *parts, uint32_t count)
{
	int rc = 0;

	*out = (struct parts){ .list = calloc((size_t)count + 1, sizeof(*out->list)) };
	if (!out->list)
		return -ENOMEM;
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		struct overlay_part *part = &out->list[out->count++];

		part->title = strdup(parts[i].title);
		part->caption = strdup(parts[i].caption);
		part->thumbnail = strdup(parts[i].thumbnail);
		part->has_page = parts[i].has_page;
		rc = part->title && part->caption && part->thumbnail ? 0 : -ENOMEM;
	}
	if (rc < 0)
		parts_free(out);
	return rc;
}

void parts_free(struct parts *parts)
{
	for (uint32_t i = 0; i < parts->count; i++) {
		free((char *)parts->list[i].title);
		free((char *)parts->list[i].caption);
		free((char *)parts->list[i].thumbnail);
	}
	free(parts->list);
	*parts = (struct parts){ 0 };
}
