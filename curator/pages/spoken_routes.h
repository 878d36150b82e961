/* What is spoken on pages, over HTTP: docs/curator.md lists the addresses. */
#ifndef GOPURA_CURATOR_PAGES_SPOKEN_ROUTES_H
#define GOPURA_CURATOR_PAGES_SPOKEN_ROUTES_H

#include "curator/api/route.h"
#include "curator/session/site.h"

/* site is borrowed for the lifetime of the table. */
struct api_routes spoken_routes(struct site *site);

#endif
