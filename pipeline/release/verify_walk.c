/* The queue of pages that are still to be checked, and what the reader of the release says. */
#include "pipeline/release/verify_walk.h"

#include <errno.h>

#include "base/array.h"

int verify_blame_reader(struct verify_walk *walk, int rc)
{
	return diagnostics_add(&walk->report->diagnostics, rc, NULL, 0, "%s",
			       release_reader_why(walk->reader));
}

int verify_child(struct verify_walk *walk, const struct verify_page *page, uint32_t child,
		 struct bytes *out)
{
	int rc = release_reader_child(walk->reader, &walk->locator, page->name,
				      page_child_offset(&page->page, child),
				      &page->page.children[child], out);

	progress_add(walk->progress, page->page.children[child].size);
	return rc < 0 ? verify_blame_reader(walk, rc) : 0;
}

int verify_queue(struct verify_walk *walk, const struct verify_task *task)
{
	int rc = map_add(&walk->seen, hash_key(task->child.hash), task->kind);

	if (rc <= 0)
		return rc;
	rc = ARRAY_RESERVE(walk->tasks, walk->task_room, walk->task_count + 1, UINT32_MAX);
	if (rc == 0)
		walk->tasks[walk->task_count++] = *task;
	return rc;
}

int verify_later(struct verify_walk *walk, const struct verify_page *page, uint32_t child,
		 enum page_kind kind)
{
	struct verify_task task = { .parent = page->name,
				    .offset = page_child_offset(&page->page, child),
				    .child = page->page.children[child],
				    .kind = kind };
	char hex[HASH_HEX_BYTES];

	if (task.child.is_page)
		return verify_queue(walk, &task);
	hash_to_hex(page->name, hex);
	return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
			       "page %s: child %u is not a page", hex, child);
}
