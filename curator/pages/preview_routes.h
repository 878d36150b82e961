/* Previews over HTTP: docs/curator.md lists the addresses. */
#ifndef GOPURA_CURATOR_PAGES_PREVIEW_ROUTES_H
#define GOPURA_CURATOR_PAGES_PREVIEW_ROUTES_H

#include "curator/api/route.h"
#include "curator/pages/preview.h"

/* preview is borrowed for the lifetime of the table. */
struct api_routes preview_routes(struct preview *preview);

#endif
