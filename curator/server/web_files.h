/* The page that a curator's browser gets: the files of curator/web, which are part of the program.
 */
#ifndef GOPURA_CURATOR_SERVER_WEB_FILES_H
#define GOPURA_CURATOR_SERVER_WEB_FILES_H

#include "base/bytes.h"

struct web_file {
	const char *path, *type; /* as in the request, and its MIME type */
	struct bytes bytes;
};

/* Returns the file that a request asks for, or NULL. */
const struct web_file *web_file_find(const char *path);

#endif
