/* Reads older texts of documents, and merges with them. */
#include "curator/store/documents_versions.h"

#include <errno.h>

#include "curator/store/documents_private.h"
#include "curator/store/text_compare.h"

int documents_versions(struct documents *documents, const char *name, struct history_version *out,
		       uint32_t max, uint32_t *count, struct diagnostics *diagnostics)
{
	int rc;

	documents_lock(documents);
	rc = documents_take_in(documents, diagnostics);
	if (rc == 0)
		rc = documents_report(
			diagnostics, history_list(documents->history, name, out, max, count), name);
	documents_unlock(documents);
	return rc;
}

int documents_read_version(struct documents *documents, const char *name, const char *version,
			   struct buffer *text, struct diagnostics *diagnostics)
{
	char id[HISTORY_ID_BYTES];
	int rc;

	documents_lock(documents);
	rc = history_find(documents->history, version, name, id);
	if (rc == 0)
		rc = history_get(documents->history, id, text);
	documents_unlock(documents);
	return rc == -ENOENT || rc == -EINVAL
		       ? diagnostics_add(diagnostics, rc, name, 0, "has no such version")
		       : documents_report(diagnostics, rc, name);
}

static int merge(struct documents *documents, const char *base, struct bytes mine,
		 struct bytes theirs, struct buffer *out, bool *is_clean)
{
	struct buffer from;
	int rc;

	buffer_init(&from, DOCUMENT_BYTES_MAX);
	rc = *base ? history_get(documents->history, base, &from) : 0;
	if (rc == 0)
		rc = text_merge(out, buffer_bytes(&from), mine, theirs, is_clean);
	buffer_finish(&from);
	return rc;
}

int documents_merge(struct documents *documents, const char *name, const char *base,
		    struct bytes mine, struct buffer *out, bool *is_clean,
		    char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics)
{
	struct buffer theirs;
	int rc;

	buffer_init(&theirs, DOCUMENT_BYTES_MAX);
	documents_lock(documents);
	rc = documents_read(documents, name, &theirs, tag, diagnostics);
	if (rc == 0)
		rc = merge(documents, base, mine, buffer_bytes(&theirs), out, is_clean);
	documents_unlock(documents);
	buffer_finish(&theirs);
	return rc < 0 ? diagnostics_add(diagnostics, rc, name, 0,
					"was changed or removed meanwhile, and the texts cannot be "
					"merged")
		      : 0;
}

int documents_keep(struct documents *documents, const char *name, struct bytes text,
		   char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics)
{
	int rc;

	documents_lock(documents);
	rc = history_put(documents->history, text, tag);
	documents_unlock(documents);
	return documents_report(diagnostics, rc, name);
}
