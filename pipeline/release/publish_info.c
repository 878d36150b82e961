/* Publishes the information page: adds the database, pictures and spoken texts. */
#include "pipeline/release/publish_info.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"

/* Adds a picture or spoken text. The file is read again and must still have the hash that the
 * database names. */
static int add_file(struct object_store *objects, const char *folder, const struct info_file *named,
		    struct page_child *out)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	if (snprintf(path, sizeof(path), "%s/%s", folder, named->name) >= PATH_MAX)
		return -ENAMETOOLONG;
	buffer_init(&file, OBJECT_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = object_store_add(objects, buffer_bytes(&file), out);
	if (rc < 0)
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	if (rc == 0 && !hash_equal(out->hash, named->hash)) {
		log_error("pipeline", "%s: changed while it was published; run the command again",
			  path);
		rc = -EBADMSG;
	}
	buffer_finish(&file);
	return rc;
}

int publish_info(struct object_store *objects, const struct info_built *info, const char *folder,
		 struct page_child *out)
{
	struct page page = { .kind = PAGE_INFO, .child_count = info->file_count + 1 };
	int rc;

	page.children = calloc(page.child_count, sizeof(*page.children));
	if (!page.children)
		return -ENOMEM;
	rc = object_store_add(objects, buffer_bytes(&info->database), &page.children[0]);
	if (rc == -EFBIG)
		log_error("pipeline",
			  "%s: the information database has %zu bytes, more than an object may "
			  "have (%d)",
			  folder, info->database.size, OBJECT_BYTES_MAX);
	for (uint32_t i = 0; rc == 0 && i < info->file_count; i++)
		rc = add_file(objects, folder, &info->files[i], &page.children[i + 1]);
	if (rc == 0)
		rc = object_store_add_page(objects, &page, out);
	free(page.children);
	return rc;
}
