/* Publishes the information page: builds the database and adds it with its pictures. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "pipeline/release/publish_sources.h"

/* Adds a picture. The file is read again and must still have the hash that the database names. */
static int add_picture(struct object_store *objects, const char *folder,
		       const struct info_picture_file *picture, struct page_child *out)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	if (snprintf(path, sizeof(path), "%s/%s", folder, picture->name) >= PATH_MAX)
		return -ENAMETOOLONG;
	buffer_init(&file, OBJECT_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = object_store_add(objects, buffer_bytes(&file), out);
	if (rc < 0)
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	if (rc == 0 && !hash_equal(out->hash, picture->hash)) {
		log_error("pipeline", "%s: changed while it was published; run the command again",
			  path);
		rc = -EBADMSG;
	}
	buffer_finish(&file);
	return rc;
}

/* All errors are logged, but only the first few warnings. */
enum { WARNINGS_SHOWN = 5 };

static void complain(void *data, bool is_error, const char *file, unsigned line, const char *text)
{
	uint32_t *warnings = data;
	char at[16] = "";

	if (line > 0)
		snprintf(at, sizeof(at), ":%u", line);
	if (is_error)
		log_error("pipeline", "%s%s: %s", file, at, text);
	else if (++*warnings <= WARNINGS_SHOWN)
		log_warn("pipeline", "%s%s: %s", file, at, text);
}

static int build(struct info_built *built, const struct info_build_options *options)
{
	struct info_build_options told = *options;
	uint32_t warnings = 0;
	int rc;

	if (!told.complaint) {
		told.complaint = complain;
		told.complaint_data = &warnings;
	}
	rc = info_build(built, &told);
	if (warnings > WARNINGS_SHOWN)
		log_warn("pipeline", "%s: and %u warnings more of pages and parts", options->folder,
			 warnings - WARNINGS_SHOWN);
	return rc;
}

int publish_info(struct object_store *objects, const struct info_build_options *options,
		 struct page_child *out)
{
	struct page page = { .kind = PAGE_INFO };
	struct info_built built;
	int rc = build(&built, options);

	if (rc < 0)
		return rc;
	page.children = calloc(built.picture_count + 1, sizeof(*page.children));
	if (!page.children)
		rc = -ENOMEM;
	if (rc == 0) {
		rc = object_store_add(objects, buffer_bytes(&built.database), &page.children[0]);
		if (rc == -EFBIG)
			log_error("pipeline",
				  "%s: the information database has %zu bytes, more "
				  "than an object may have (%d)",
				  options->folder, built.database.size, OBJECT_BYTES_MAX);
	}
	for (uint32_t i = 0; rc == 0 && i < built.picture_count; i++)
		rc = add_picture(objects, options->folder, &built.pictures[i],
				 &page.children[i + 1]);
	page.child_count = built.picture_count + 1;
	if (rc == 0)
		rc = object_store_add_page(objects, &page, out);
	free(page.children);
	info_built_finish(&built);
	return rc;
}
