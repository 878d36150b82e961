/* Queries of the information database that run in SQLite: credits and search. */
#ifndef GOPURA_STORAGE_INFO_ASK_H
#define GOPURA_STORAGE_INFO_ASK_H

#include "storage/info.h"

/* Returns the credits of a part's information in one line (creator, date, source, rights and so
 * on), "" if nothing is known. Borrowed until the next info_credits or info_close. */
const char *info_credits(struct info *info, uint32_t part, const char *language);

/* Searches for parts that contain every word of query; the end of each word may be missing. Parts
 * found in that language come first, and among them titles before captions before pages. Writes at
 * most `most` parts and returns how many; 0 for a query without words. */
uint32_t info_search(struct info *info, const char *query, const char *language, uint32_t *parts,
		     uint32_t most);

#endif
