/* Numbers that the kernel tells in the text files of /proc. */
#ifndef GOPURA_BASE_PROC_NUMBER_H
#define GOPURA_BASE_PROC_NUMBER_H

#include <stdbool.h>

/* Finds the first line of a file that matches scan, a sscanf format with one number (%llu), in its
 * first 4095 bytes. Returns false if there is none; *out may then be undefined. */
bool proc_number(const char *path, const char *scan, unsigned long long *out);

#endif
