/* Publishing over HTTP: docs/curator.md lists the addresses. */
#ifndef GOPURA_CURATOR_PUBLISH_PUBLISH_ROUTES_H
#define GOPURA_CURATOR_PUBLISH_PUBLISH_ROUTES_H

#include <pthread.h>

#include "curator/api/route.h"

/* Of a content folder; the lock is private. */
struct publish_place {
	const char *folder; /* borrowed, as release */
	const char
		*release; /* the release folder, which is only read; NULL: nothing is published */
	pthread_mutex_t asking;    /* held while a request is written */
	pthread_mutex_t comparing; /* held while changes are found, which takes memory */
};

/* With a release, makes the folder that the publisher waits at. Errors of the disk are logged: then
 * nobody can publish. */
void publish_place_init(struct publish_place *place, const char *folder, const char *release);
void publish_place_finish(struct publish_place *place);

/* place is borrowed for the lifetime of the table. */
struct api_routes publish_routes(struct publish_place *place);

#endif
