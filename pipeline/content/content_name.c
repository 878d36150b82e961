/* Judges a name by its characters and parts. */
#include "pipeline/content/content_name.h"

#include <string.h>

bool content_name_is_safe(const char *name)
{
	if (name[0] == '\0' || name[0] == '/')
		return false;
	for (const char *c = name; *c; c++)
		if ((unsigned char)*c < 0x20 || *c == 0x7f || *c == '\\')
			return false;
	for (const char *c = name; *c;) {
		size_t length = strcspn(c, "/");

		if (length == 0 || (c[0] == '.' && (length == 1 || (length == 2 && c[1] == '.'))))
			return false;
		c += length;
		if (*c == '/' && *++c == '\0')
			return false;
	}
	return true;
}
