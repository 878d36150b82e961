/* Reads the beginning of a file of /proc and scans it line by line. */
#include "base/proc_number.h"

#include <stdio.h>
#include <string.h>

bool proc_number(const char *path, const char *scan, unsigned long long *out)
{
	char text[4096];
	FILE *file = fopen(path, "re");
	size_t size = file ? fread(text, 1, sizeof(text) - 1, file) : 0;
	const char *at = text;

	if (file)
		fclose(file);
	text[size] = '\0';
	for (; at && *at; at = strchr(at, '\n'), at += at ? 1 : 0)
		if (sscanf(at, scan, out) == 1)
			return true;
	return false;
}
