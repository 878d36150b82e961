/* Changes of a part's texts as a browser sends them, made one after another: {"changes": [...]}. */
#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>

#include "curator/pages/part_change.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *member(const cJSON *json, const char *key)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));

	return text ? text : "";
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	cJSON *json = cJSON_ParseWithLength((const char *)data, size);
	cJSON *part = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(json, "part"), true);
	const cJSON *item;
	struct buffer theirs;

	if (!cJSON_IsObject(part)) {
		cJSON_Delete(part);
		part = cJSON_CreateObject();
	}
	buffer_init(&theirs, 1 << 20);
	cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(json, "changes"))
	{
		const struct part_change change = { member(item, "field"), member(item, "language"),
						    member(item, "from"), member(item, "to") };

		/* What was changed to a text has that text, so the same change agrees. */
		if (part_change_make(part, &change, &theirs, NULL) == 0 &&
		    part_change_make(part, &change, &theirs, NULL) == -EINVAL)
			abort();
	}
	buffer_finish(&theirs);
	cJSON_Delete(part);
	cJSON_Delete(json);
	return 0;
}
