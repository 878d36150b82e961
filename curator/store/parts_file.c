/* Reads parts.json. */
#include "curator/store/parts_file.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "curator/store/json_document.h"

int parts_file_read(struct parts_file *out, struct documents *documents,
		    struct diagnostics *diagnostics)
{
	const cJSON *list;
	int rc;

	*out = (struct parts_file){ 0 };
	rc = json_document_read(&out->root, documents, PARTS_FILE, PARTS_FILE_BYTES_MAX, out->tag,
				diagnostics);
	list = cJSON_GetObjectItemCaseSensitive(out->root, "parts");
	if (list && !cJSON_IsArray(list))
		rc = diagnostics_add(diagnostics, -EINVAL, PARTS_FILE, 0,
				     "\"parts\" is not a list");
	if (rc < 0)
		parts_file_finish(out);
	return rc;
}

void parts_file_finish(struct parts_file *parts)
{
	if (!parts)
		return;
	cJSON_Delete(parts->root);
	*parts = (struct parts_file){ 0 };
}

cJSON *parts_file_list(const struct parts_file *parts)
{
	cJSON *list = cJSON_GetObjectItemCaseSensitive(parts->root, "parts");

	return list ? list : cJSON_AddArrayToObject(parts->root, "parts");
}

cJSON *parts_file_find(const struct parts_file *parts, const char *id)
{
	cJSON *part;

	cJSON_ArrayForEach(part, cJSON_GetObjectItemCaseSensitive(parts->root, "parts"))
	{
		const cJSON *its = cJSON_GetObjectItemCaseSensitive(part, "id");

		if (cJSON_IsString(its) && strcmp(its->valuestring, id) == 0)
			return part;
	}
	return NULL;
}
