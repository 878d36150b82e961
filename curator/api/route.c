/* Compares paths with patterns. */
#include "curator/api/route.h"

#include <string.h>

static const char value_characters[] =
	"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/* Moves both behind a placeholder and what stands for it. */
static bool take_parameter(struct api_request *request, const char **pattern, const char **path)
{
	const char *name = *pattern + 1, *end = strchr(name, '}');
	const size_t bytes = strspn(*path, value_characters);
	struct api_parameter *parameter = &request->parameters[request->parameter_count];

	if (!end || request->parameter_count == API_PARAMETERS_MAX || bytes == 0 ||
	    bytes >= sizeof(parameter->value))
		return false;
	parameter->name = name;
	parameter->name_bytes = (size_t)(end - name);
	memcpy(parameter->value, *path, bytes);
	parameter->value[bytes] = '\0';
	request->parameter_count++;
	*pattern = end + 1;
	*path += bytes;
	return true;
}

bool route_fits(const char *pattern, struct api_request *request)
{
	const char *path = request->path;

	request->parameter_count = 0;
	while (*pattern)
		if (*pattern == '{') {
			if (!take_parameter(request, &pattern, &path))
				return false;
		} else if (*pattern++ != *path++) {
			return false;
		}
	return *path == '\0';
}

const struct api_route *route_find(const struct api_routes *tables, uint32_t table_count,
				   struct api_request *request, void **user, unsigned *allowed)
{
	*allowed = 0;
	for (uint32_t t = 0; t < table_count; t++)
		for (uint32_t n = 0; n < tables[t].count; n++) {
			const struct api_route *route = &tables[t].routes[n];

			if (!route_fits(route->pattern, request))
				continue;
			*allowed |= 1u << route->method;
			if (route->method == request->method) {
				*user = tables[t].user;
				return route;
			}
		}
	return NULL;
}
