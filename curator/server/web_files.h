/* The pages that a curator's browser gets: the files of curator/web, which are part of the program.
 */
#ifndef GOPURA_CURATOR_SERVER_WEB_FILES_H
#define GOPURA_CURATOR_SERVER_WEB_FILES_H

#include "base/bytes.h"
#include "format/hash.h"

struct web_file {
	const char *path, *type;    /* as in the request, and its MIME type */
	bool is_open;               /* for those who are not signed in, too */
	struct bytes bytes, zipped; /* as it is, and by gzip */
	char tag[HASH_HEX_BYTES];
};

/* Returns the file that a request asks for, or NULL. */
const struct web_file *web_file_find(const char *path);

#endif
