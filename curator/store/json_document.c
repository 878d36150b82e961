/* Tells a document that is not there from one that is not valid, and from a lack of memory. */
#include "curator/store/json_document.h"

#include <cjson/cJSON.h>
#include <errno.h>

#include "base/json_tree.h"

int json_document_read(cJSON **out, struct documents *documents, const char *name, size_t bytes_max,
		       char tag[DOCUMENT_TAG_BYTES], struct diagnostics *diagnostics)
{
	struct buffer text;
	int rc;

	*out = NULL;
	buffer_init(&text, bytes_max);
	rc = documents_read(documents, name, &text, tag, diagnostics);
	if (rc < 0 && rc != -ENOENT) {
		buffer_finish(&text);
		return rc;
	}
	if (rc == 0)
		rc = json_parse(out, buffer_bytes(&text));
	else
		rc = (*out = cJSON_CreateObject()) ? 0 : -ENOMEM;
	buffer_finish(&text);
	if (cJSON_IsObject(*out))
		return 0;
	cJSON_Delete(*out);
	*out = NULL;
	if (rc == -ENOMEM)
		return diagnostics_add(diagnostics, rc, name, 0,
				       "cannot be read: no memory is left");
	return diagnostics_add(diagnostics, -EINVAL, name, 0,
			       "is not valid: 'gopura-content build' names the line");
}
