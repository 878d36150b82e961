/* Arrays that may be larger than memory. A small one lies in the heap; a large one is a mapping of
 * an unnamed temporary file, so that the kernel can write it out and what is resident can be
 * limited: spill_breathe lets go of the pages that were touched, and touching them again brings
 * them back.
 *
 * The file's space is allocated in advance: a full disk is an error of the call, not a signal
 * later. Any thread may call. */
#ifndef GOPURA_BASE_SPILL_H
#define GOPURA_BASE_SPILL_H

#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

enum {
	SPILL_MIN_BYTES = 32 << 20,       /* smaller arrays lie in the heap */
	SPILL_RESIDENT_BYTES = 512 << 20, /* spill_breathe lets go of what is above this */
};

/* Sets the folder of the temporary files; copied. Without it they lie in $TMPDIR, or else in
 * /var/tmp, which unlike /tmp is never memory. */
void spill_set_folder(const char *folder);

/* Returns zeroed memory; spill_free ends it. NULL: errno is ENOMEM, ENOSPC (the disk is full), or
 * an error of the folder. */
must_check void *spill_alloc(size_t bytes);
/* Returns what to do where that failed of the folder of the temporary files, as a sentence. NULL:
 * rc is another failure. */
const char *spill_folder_cure(int rc);
/* Changes how many items of its type `array`, a pointer, has; it may also come from malloc, or be
 * NULL with old_count 0. Items that are added are zeroed. Returns 0, or a negative errno as above:
 * array is unchanged. */
#define SPILL_RESIZE(array, old_count, count)                                                      \
	spill_resize(&(array), (old_count), (count), sizeof(*(array)))

/* For SPILL_RESIZE, and where the type is not known: array is the address of a pointer to items of
 * item_bytes each. */
must_check int spill_resize(void *array, size_t old_count, size_t count, size_t item_bytes);
/* Maps part of a file for reading; a small part is copied. The file must not change while it is
 * mapped. The descriptor may be closed. NULL: errno. Writing to it is a fault of ours. */
must_check void *spill_map(int fd, uint64_t offset, size_t bytes);
/* Gives back the memory and the space on the disk of a part of an array whose contents are no
 * longer needed; they become undefined. Does nothing for small arrays. */
void spill_discard(void *part, size_t bytes);
/* Frees an array of this module or of malloc. NULL is fine. */
void spill_free(void *array);

/* Lets go of resident pages of large arrays if there are more than SPILL_RESIDENT_BYTES. Contents
 * stay as they are. Costs microseconds: call it every few ten thousand items. */
void spill_breathe(void);
/* The same for item i of a pass over large arrays; nearly always does nothing. */
static inline void spill_pass(uint64_t i)
{
	if ((i & 0xffff) == 0)
		spill_breathe();
}

#endif
