/* Reads and prints parts.json. */
#include "curator/store/parts_file.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"

static const char no_memory[] = "cannot be read: no memory is left";

static int judge(const cJSON *root, struct diagnostics *diagnostics)
{
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "parts");

	if (!cJSON_IsObject(root))
		return diagnostics_add(diagnostics, -EINVAL, PARTS_FILE, 0,
				       "is not valid: 'gopura-content build' names the line");
	if (list && !cJSON_IsArray(list))
		return diagnostics_add(diagnostics, -EINVAL, PARTS_FILE, 0,
				       "\"parts\" is not a list");
	return 0;
}

static int parse(struct parts_file *out, struct bytes text, struct diagnostics *diagnostics)
{
	if (json_parse(&out->root, text) == -ENOMEM)
		return diagnostics_add(diagnostics, -ENOMEM, PARTS_FILE, 0, "%s", no_memory);
	return judge(out->root, diagnostics);
}

int parts_file_read(struct parts_file *out, struct documents *documents,
		    struct diagnostics *diagnostics)
{
	struct buffer text;
	int rc;

	*out = (struct parts_file){ 0 };
	buffer_init(&text, PARTS_FILE_BYTES_MAX);
	rc = documents_read(documents, PARTS_FILE, &text, out->tag, diagnostics);
	if (rc == 0)
		rc = parse(out, buffer_bytes(&text), diagnostics);
	else if (rc == -ENOENT && (out->root = cJSON_CreateObject()))
		rc = 0;
	else if (rc == -ENOENT)
		rc = diagnostics_add(diagnostics, -ENOMEM, PARTS_FILE, 0, "%s", no_memory);
	buffer_finish(&text);
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

int json_print(const cJSON *json, struct buffer *out)
{
	char *text = json_indented(json);

	if (!text)
		return -ENOMEM;
	buffer_put_text(out, text);
	buffer_put_u8(out, '\n');
	cJSON_free(text);
	return out->error;
}

/* cJSON's own replace functions add nothing that is missing. */
bool json_set(cJSON *object, const char *key, cJSON *item)
{
	if (!item)
		return false;
	if (cJSON_GetObjectItemCaseSensitive(object, key)) {
		if (cJSON_ReplaceItemInObjectCaseSensitive(object, key, item))
			return true;
		cJSON_Delete(item);
		return false;
	}
	return json_add(object, key, item);
}
