/* Allocators that cJSON calls, which note what fails. */
#include "base/json_tree.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdlib.h>

static _Thread_local bool lacked;

static void *allocate(size_t size)
{
	void *at = malloc(size);

	lacked |= !at;
	return at;
}

__attribute__((constructor)) static void begin(void)
{
	cJSON_InitHooks(&(cJSON_Hooks){ .malloc_fn = allocate, .free_fn = free });
}

int json_parse_to(cJSON **out, struct bytes text, const char **end)
{
	const bool lacked_before = lacked;
	int rc = -EBADMSG;

	*out = NULL;
	lacked = false;
	if (text.size > 0)
		*out = cJSON_ParseWithLengthOpts((const char *)text.data, text.size, end, false);
	if (*out)
		rc = 0;
	else if (lacked)
		rc = -ENOMEM;
	lacked |= lacked_before;
	return rc;
}

int json_parse(cJSON **out, struct bytes text)
{
	return json_parse_to(out, text, NULL);
}

int json_parse_object(cJSON **out, struct bytes text)
{
	const char *at, *const end = (const char *)text.data + text.size;
	int rc = json_parse_to(out, text, &at);

	if (rc < 0)
		return rc;
	while (at < end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t'))
		at++;
	if (at == end && cJSON_IsObject(*out))
		return 0;
	cJSON_Delete(*out);
	*out = NULL;
	return -EBADMSG;
}

bool json_add(cJSON *object, const char *key, cJSON *item)
{
	if (cJSON_AddItemToObject(object, key, item))
		return true;
	cJSON_Delete(item);
	return false;
}

bool json_append(cJSON *array, cJSON *item)
{
	if (cJSON_AddItemToArray(array, item))
		return true;
	cJSON_Delete(item);
	return false;
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

static char *whole(char *text)
{
	if (lacked) {
		free(text);
		text = NULL;
	}
	lacked = false;
	return text;
}

char *json_line(const cJSON *json)
{
	return whole(cJSON_PrintUnformatted(json));
}

char *json_indented(const cJSON *json)
{
	return whole(cJSON_Print(json));
}

int json_print(const cJSON *json, struct buffer *out)
{
	char *text = json_indented(json);

	if (!text)
		return -ENOMEM;
	buffer_put_text(out, text);
	buffer_put_u8(out, '\n');
	free(text);
	return out->error;
}
