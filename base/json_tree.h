/* cJSON with a lack of memory told apart. By itself it gives NULL for a text that is no JSON and
 * for one that there is no memory for, and leaves out a member that cannot be allocated without a
 * word. Here an allocation of cJSON that fails is noted for its thread until a tree is printed
 * there. */
#ifndef GOPURA_BASE_JSON_TREE_H
#define GOPURA_BASE_JSON_TREE_H

#include "base/bytes.h"

struct cJSON;

/* Parses a text, which may have anything behind its value. *out is for cJSON_Delete; NULL on
 * failure. -EBADMSG: it is not JSON; -ENOMEM. */
must_check int json_parse(struct cJSON **out, struct bytes text);
/* As json_parse; *end is set to the first byte behind the value or, on failure, to about where it
 * cannot go on. NULL: not wanted; a text without bytes sets nothing. */
must_check int json_parse_to(struct cJSON **out, struct bytes text, const char **end);
/* As json_parse, for one object with nothing but white space behind it. */
must_check int json_parse_object(struct cJSON **out, struct bytes text);

/* Add an item to an object, or at the end of an array. item is taken, also where it is not added:
 * because it is NULL, or what it should go into, or because no memory is left. */
bool json_add(struct cJSON *object, const char *key, struct cJSON *item);
bool json_append(struct cJSON *array, struct cJSON *item);

/* As json_add, in the place of a member of that name where there is one. */
must_check bool json_set(struct cJSON *object, const char *key, struct cJSON *item);

/* Returns the text of a tree, for free: in one line, or indented for people. NULL: memory was
 * lacking, now or since the last call on this thread, so that the tree may not be whole. */
must_check char *json_line(const struct cJSON *json);
must_check char *json_indented(const struct cJSON *json);
/* Appends a tree as the text of a file: indented, with an end of line. -ENOMEM, as above; -EFBIG.
 */
must_check int json_print(const struct cJSON *json, struct buffer *out);

#endif
