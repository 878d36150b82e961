/* Short forms for reading cJSON's trees: a member that may be missing, and values that JSON-LD
 * allows to be one thing or a list of things. */
#ifndef GOPURA_PIPELINE_IMPORT_JSON_H
#define GOPURA_PIPELINE_IMPORT_JSON_H

#include <cjson/cJSON.h>

/* Each returns NULL if there is no such thing; NULL and values of another kind are fine. What is
 * returned is borrowed from the tree. */
static inline const cJSON *json_member(const cJSON *object, const char *key)
{
	return cJSON_IsObject(object) ? cJSON_GetObjectItemCaseSensitive(object, key) : NULL;
}

static inline const char *json_string(const cJSON *object, const char *key)
{
	return cJSON_GetStringValue(json_member(object, key));
}

/* for (at = json_first(value); at; at = json_next(value, at)) */
static inline const cJSON *json_first(const cJSON *one_or_many)
{
	return cJSON_IsArray(one_or_many) ? one_or_many->child : one_or_many;
}

static inline const cJSON *json_next(const cJSON *one_or_many, const cJSON *at)
{
	return cJSON_IsArray(one_or_many) ? at->next : NULL;
}

#endif
