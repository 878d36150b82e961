/* The routes of tours: reading, saving and flying them. */
#ifndef GOPURA_CURATOR_PAGES_TOUR_ROUTES_H
#define GOPURA_CURATOR_PAGES_TOUR_ROUTES_H

#include "curator/api/route.h"
#include "curator/session/site.h"

/* site is borrowed. */
struct api_routes tour_routes(struct site *site);

#endif
