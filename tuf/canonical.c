/* Writes a cJSON tree, the members of each object sorted by the bytes of their names, which is the
 * order of their code points. */
#include "tuf/canonical.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 2^53: JSON numbers are doubles to most readers, and an integer must survive that. */
static const double whole_most = 9007199254740992.0;

static int write_number(struct buffer *out, double value)
{
	if (!(fabs(value) <= whole_most) || floor(value) != value)
		return -EBADMSG;
	buffer_print(out, "%.0f", value + 0.0); /* -0 is 0 */
	return out->error;
}

static int write_text(struct buffer *out, const char *text)
{
	buffer_put_u8(out, '"');
	for (; *text; text++) {
		if (*text == '"' || *text == '\\')
			buffer_put_u8(out, '\\');
		buffer_put_u8(out, (uint8_t)*text);
	}
	buffer_put_u8(out, '"');
	return out->error;
}

static int by_name(const void *a, const void *b)
{
	const cJSON *const *left = a, *const *right = b;

	return strcmp((*left)->string, (*right)->string);
}

static int write_members(struct buffer *out, const cJSON *const *members, size_t count)
{
	int rc = 0;

	for (size_t i = 0; i < count && rc == 0; i++) {
		if (i > 0 && strcmp(members[i - 1]->string, members[i]->string) == 0)
			return -EBADMSG;
		if (i > 0)
			buffer_put_u8(out, ',');
		rc = write_text(out, members[i]->string);
		buffer_put_u8(out, ':');
		if (rc == 0)
			rc = canonical_write(out, members[i]);
	}
	return rc;
}

static int write_object(struct buffer *out, const cJSON *object)
{
	const size_t count = (size_t)cJSON_GetArraySize(object);
	const cJSON **members = calloc(count + 1, sizeof(*members));
	const cJSON *member;
	size_t i = 0;
	int rc;

	if (!members)
		return -ENOMEM;
	cJSON_ArrayForEach(member, object) members[i++] = member;
	qsort(members, count, sizeof(*members), by_name);
	buffer_put_u8(out, '{');
	rc = write_members(out, members, count);
	buffer_put_u8(out, '}');
	free(members);
	return rc < 0 ? rc : out->error;
}

static int write_array(struct buffer *out, const cJSON *array)
{
	const cJSON *item;
	int rc = 0;

	buffer_put_u8(out, '[');
	cJSON_ArrayForEach(item, array)
	{
		if (item != array->child)
			buffer_put_u8(out, ',');
		rc = canonical_write(out, item);
		if (rc < 0)
			return rc;
	}
	buffer_put_u8(out, ']');
	return out->error;
}

/* Goes no deeper than the parser did (CJSON_NESTING_LIMIT). */
int canonical_write(struct buffer *out, const cJSON *value)
{
	if (cJSON_IsObject(value))
		return write_object(out, value);
	if (cJSON_IsArray(value))
		return write_array(out, value);
	if (cJSON_IsString(value))
		return write_text(out, value->valuestring);
	if (cJSON_IsNumber(value))
		return write_number(out, value->valuedouble);
	buffer_put_text(out, cJSON_IsTrue(value)    ? "true"
			     : cJSON_IsFalse(value) ? "false"
						    : "null");
	return out->error;
}
