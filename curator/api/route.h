/* Tables of routes, and which route a request means. */
#ifndef GOPURA_CURATOR_API_ROUTE_H
#define GOPURA_CURATOR_API_ROUTE_H

#include "curator/api/http_api.h"

struct api_route {
	enum api_method method;
	/* As "/api/pages/{id}.{language}": {name} stands for 1 to 64 characters of A-Z a-z 0-9 - _,
	 * and is followed by the end, '/' or '.'. At most API_PARAMETERS_MAX of them. */
	const char *pattern;
	enum role role; /* the least */
	/* The longest body, at most API_UPLOAD_BYTES_MAX. 0: it has none. */
	uint32_t body_bytes_max;
	bool slow; /* may wait for the disk or computes for long: runs on a worker thread */
	void (*handle)(void *user, const struct api_request *request,
		       struct api_response *response);
};

/* A module's routes, and what its handlers get. */
struct api_routes {
	const struct api_route *routes; /* static */
	uint32_t count;
	void *user; /* borrowed */
};

/* Finds the first route with this method and path, and sets the parameters of the request. *user is
 * set to that of the table. Returns NULL if there is none; *allowed is then a bit for each method
 * (1 << API_GET ...) for which the path has a route: 0 means that there is no such path. */
const struct api_route *route_find(const struct api_routes *tables, uint32_t table_count,
				   struct api_request *request, void **user, unsigned *allowed);

/* Returns whether a path fits a pattern, and sets the parameters. */
bool route_fits(const char *pattern, struct api_request *request);

#endif
